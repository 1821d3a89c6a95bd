#include "bespoke/surface_fit/detail/anchor_meeting.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "bespoke/rbf/kernels.h"
#include "bespoke/surface_fit/detail/misoriented_faces.h"

namespace bespoke {
namespace {

// Of the largest move. The first is a tenth; the last leaves a millionth of a move.
constexpr double first_variance = 0.01, growth_of_variance = 4;
constexpr int max_doublings = 14;

/// Centres of faces that `met` stretches beyond the factor, and more than the surface was before.
std::vector<Vector3> overstretched(const TriangleMesh& surface, const Points& met, const Points& coarse,
                                   double max_stretch) {
  std::vector<Vector3> centres;
  const Faces& faces = surface.faces;
  for (Eigen::Index face = 0; face < faces.cols(); ++face) {
    const double stretch = face_stretch(faces, face, coarse, met);
    if (!(stretch > max_stretch) || !(stretch > face_stretch(faces, face, coarse, surface.vertices)))
      continue;
    centres.push_back((surface.vertices.col(faces(0, face)) + surface.vertices.col(faces(1, face)) +
                       surface.vertices.col(faces(2, face))) /
                      3);
  }
  return centres;
}

/// Anchors near others whose moves differ by more than a layer's gradient allows: these hold all others back,
/// since a layer is scaled as a whole.
std::vector<Vector3> contradicting(const Points& anchors, const Points& moves, double radius,
                                   double max_gradient) {
  std::vector<Vector3> places;
  for (Eigen::Index j = 0; j < anchors.cols(); ++j)
    for (Eigen::Index i = 0; i < anchors.cols(); ++i) {
      const double apart = (anchors.col(i) - anchors.col(j)).norm();
      if (apart > radius || !((moves.col(i) - moves.col(j)).norm() > max_gradient * apart)) continue;
      places.push_back(anchors.col(j));
      break;
    }
  return places;
}

/// Raises the variances of the anchors within a radius of the places; whether there was one.
bool raise_around(const std::vector<Vector3>& places, const Points& anchors, double radius,
                  Eigen::VectorXd& variances) {
  bool any = false;
  for (Eigen::Index k = 0; k < anchors.cols(); ++k)
    for (const Vector3& place : places) {
      if (!((place - anchors.col(k)).norm() <= radius)) continue;
      variances[k] = std::max(first_variance, growth_of_variance * variances[k]);
      any = true;
      break;
    }
  return any;
}

/// Simple kriging with noise: the moves (3×k) as samples, with these variances, of a field whose covariance
/// is the layer's kernel.
Points smoothed(const Points& anchors, const Points& moves, double radius, const Eigen::VectorXd& variances) {
  const Eigen::Index count = anchors.cols();
  Eigen::MatrixXd kernel(count, count);
  for (Eigen::Index j = 0; j < count; ++j)
    for (Eigen::Index i = 0; i < count; ++i) {
      const double s = (anchors.col(i) - anchors.col(j)).norm() / radius;
      kernel(i, j) = s < 1 ? WendlandC4::value(s) : 0;
    }
  Eigen::MatrixXd system = kernel;
  constexpr double ridge = 1e-9;  // of equal anchors
  system.diagonal().array() += variances.array() + ridge;
  return (kernel * system.ldlt().solve(moves.transpose())).transpose();
}

}  // namespace

AnchorMeeting meet_anchors_within(const DetailInput& input, const Points& coarse, double max_stretch,
                                  const DetailSettings& settings) {
  const Points& anchors = input.anchor_sources;
  const double radius = settings.anchor_radius;
  DetailFit fit = meet_anchors(input, settings);
  Eigen::VectorXd variances = Eigen::VectorXd::Zero(anchors.cols());
  if (anchors.cols() == 0) return {fit.vertices, variances};
  const Points moves = input.anchor_targets - anchors;
  Points targets = input.anchor_targets;
  for (int round = 0; round < max_doublings; ++round) {
    std::vector<Vector3> places = overstretched(input.surface, fit.vertices, coarse, max_stretch);
    const double missed = (targets - fit.anchor_sources).colwise().norm().maxCoeff();
    if (places.empty() && missed > settings.tolerance)
      places = contradicting(anchors, targets - anchors, radius, settings.max_gradient);
    if (places.empty() || !raise_around(places, anchors, radius, variances)) break;
    targets = anchors + smoothed(anchors, moves, radius, variances);
    for (Eigen::Index k = 0; k < anchors.cols(); ++k)
      if (variances[k] == 0) targets.col(k) = input.anchor_targets.col(k);
    const DetailInput relaxed{input.surface, input.target, anchors, targets, input.hidden, input.patches};
    fit = meet_anchors(relaxed, settings);
  }
  const double largest = moves.colwise().norm().maxCoeff();
  return {fit.vertices, largest * variances.cwiseSqrt()};
}

}  // namespace bespoke
