#include "bespoke/registration/detail/anchor_start.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/mesh/spread_points.h"
#include "bespoke/number_format.h"
#include "bespoke/rigid/rigid_alignment.h"

namespace bespoke {
namespace {

constexpr std::size_t places_of_a_model = 500;

Points some_vertices(const TriangleMesh& mesh) {
  return mesh.vertices(Eigen::all, spread_vertices(mesh, places_of_a_model));
}

Similarity inverse_of(const Similarity& map) {
  Similarity inverse;
  inverse.scale = 1 / map.scale;
  inverse.rotation = map.rotation.transpose();
  inverse.translation = -(inverse.scale * (inverse.rotation * map.translation));
  return inverse;
}

double mean_distance(const ClosestPointTree& surface, const Points& places) {
  double sum = 0;
  for (const auto& place : places.colwise())
    sum += std::sqrt(surface.closest(Vector3(place))->squared_distance);
  return sum / double(places.cols());
}

double root_mean_square(const Eigen::VectorXd& lengths) {
  return std::sqrt(lengths.squaredNorm() / double(lengths.size()));
}

/// How far each pair may be off without saying anything: by its σ, and by what remeshing leaves. weights: as
/// spline_weights.
Eigen::VectorXd tolerances(const Points& targets, const Eigen::VectorXd& weights, double size) {
  constexpr double resolution = 1e-3, spline_difference = 0.1;  // of the diagonals of target and targets
  return (spline_difference * diagonal(targets) * weights.cwiseSqrt().cwiseInverse()).array() +
         resolution * size;
}

/// Whether the anchors spread along each of their directions at least half as widely as the vertices.
bool spread_like(const Points& vertices, const RegularisedAlignment& alignment) {
  constexpr double share = 0.5;  // as for a uniform spread over half of the source
  const Points arms = alignment.directions.transpose() * (vertices.colwise() - vertices.rowwise().mean());
  const Vector3 widths = arms.rowwise().norm() / std::sqrt(double(vertices.cols()));
  return (alignment.widths.array() >= share * widths.array()).all();
}

// ---- Mirror images

/// Both ways to take the pairs: as they are, and with the source reflected before.
struct Handedness {
  Eigen::VectorXd turned, mirrored;             // distances of the pairs under either similarity
  double turned_apart = 0, mirrored_apart = 0;  // of the surfaces
};

Handedness both_ways(const RegularisedAlignment& alignment, const Points& sources, const Points& targets,
                     const Eigen::VectorXd& weights, const SimilarityDistance& distance) {
  const Points mirror_image = reflected(alignment, sources);
  const Similarity of_mirror_image = align_similarly(mirror_image, targets, weights);
  return {(alignment.similarity * sources - targets).colwise().norm(),
          (of_mirror_image * mirror_image - targets).colwise().norm(), distance(alignment.similarity),
          distance.after(of_mirror_image, alignment)};
}

/// A likelihood ratio: the pairs by their freedom, the surfaces as ten pairs more, since they meet anywhere
/// near. A mirror image it is at odds of a thousand to one, if it is nearer by a factor of one and a half in
/// one of the two.
bool is_mirrored(const Handedness& ways, const Eigen::VectorXd& tolerances) {
  constexpr double surfaces_as_pairs = 10, fixed_by_three_pairs = 3;
  constexpr double clearly = 1.5, odds = 1000;
  const auto misfit = [&](const Eigen::VectorXd& distances) {
    return std::hypot(1, root_mean_square(distances.cwiseQuotient(tolerances)));
  };
  const double floor = tolerances.minCoeff();
  const double pairs = misfit(ways.turned) / misfit(ways.mirrored);
  const double surfaces = (ways.turned_apart + floor) / (ways.mirrored_apart + floor);
  const double freedom = std::max(0.0, double(ways.turned.size()) - fixed_by_three_pairs);
  return std::max(pairs, surfaces) >= clearly && std::min(pairs, surfaces) >= 1 / clearly &&
         freedom * std::log(pairs) + surfaces_as_pairs * std::log(surfaces) >= std::log(odds);
}

/// Those that a mirror image meets better by half, the worst first.
std::string mirrored_anchors(const Anchors& anchors, const Handedness& ways) {
  constexpr std::size_t max_named = 5;
  std::vector<Eigen::Index> order(static_cast<std::size_t>(ways.turned.size()));
  std::iota(order.begin(), order.end(), 0);
  std::erase_if(order, [&](Eigen::Index i) { return !(ways.turned[i] > 2 * ways.mirrored[i]); });
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index i, Eigen::Index j) {
    return ways.turned[i] - ways.mirrored[i] > ways.turned[j] - ways.mirrored[j];
  });
  std::string text;
  for (std::size_t k = 0; k < std::min(order.size(), max_named); ++k)
    text += (k == 0 ? "" : ", ") + label(anchors, static_cast<std::size_t>(order[k]));
  if (order.size() > max_named) text += " and " + std::to_string(order.size() - max_named) + " more";
  return text;
}

void require_unmirrored_pairs(const Handedness& ways, const Anchors& anchors,
                              const Eigen::VectorXd& tolerances) {
  if (!is_mirrored(ways, tolerances)) return;
  const std::string named = mirrored_anchors(anchors, ways);
  throw InvalidInput(
      "one model is a mirror image of the other, or the anchors' left and right are exchanged: anchors are "
      "met to " +
      format_number(root_mean_square(ways.mirrored), 3) +
      " (root mean square) by a mirror image of the source, to " +
      format_number(root_mean_square(ways.turned), 3) + " by the source; the surfaces to " +
      format_number(ways.mirrored_apart, 3) + " and " + format_number(ways.turned_apart, 3) + " (mean)" +
      (named.empty() ? std::string() : "; the anchors that say so: " + named) +
      "; mirror it back first, or name them anew");
}

// ---- Turns about a line

/// About the line through `centre` along `axis` (unit), radians.
RigidTransform turn_about(const Vector3& centre, const Vector3& axis, double angle) {
  const Matrix3 rotation = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  return {rotation, centre - rotation * centre};
}

/// Of the source about the line along which alone the anchors spread; the identity where none is clearly
/// better.
RigidTransform turn_by_surfaces(const RegularisedAlignment& alignment, const SimilarityDistance& distance) {
  constexpr int turns = 36;
  constexpr double clearly_nearer = 0.8;
  double least = clearly_nearer * distance(alignment.similarity);
  RigidTransform best;
  for (int k = 1; k < turns; ++k) {
    const RigidTransform turn =
        turn_about(alignment.source_centre, alignment.directions.col(0), 2 * std::numbers::pi * k / turns);
    const double apart = distance(alignment.similarity * Similarity{1, turn.rotation, turn.translation});
    if (!(apart < least)) continue;
    least = apart;
    best = turn;
  }
  return best;
}

}  // namespace

SimilarityDistance::SimilarityDistance(const TriangleMesh& source, const TriangleMesh& target)
    : source_surface_(source),
      target_surface_(target),
      source_places_(some_vertices(source)),
      target_places_(some_vertices(target)) {}

double SimilarityDistance::operator()(const Similarity& target_from_source) const {
  const double back = target_from_source.scale *
                      mean_distance(source_surface_, inverse_of(target_from_source) * target_places_);
  return (mean_distance(target_surface_, target_from_source * source_places_) + back) / 2;
}

double SimilarityDistance::after(const Similarity& target_from_source,
                                 const RegularisedAlignment& reflection) const {
  const Points back = reflected(reflection, inverse_of(target_from_source) * target_places_);
  return (mean_distance(target_surface_, target_from_source * reflected(reflection, source_places_)) +
          target_from_source.scale * mean_distance(source_surface_, back)) /
         2;
}

AnchorStart start_by_anchors(const Anchors& anchors, const Eigen::VectorXd& weights,
                             const TriangleMesh& source, const TriangleMesh& target) {
  const Points sources = source_points(anchors), targets = target_points(anchors);
  AnchorStart start;
  start.target_from_source = align_rigidly(sources, targets, weights);
  const Eigen::VectorXd within = tolerances(targets, weights, diagonal(target.vertices));
  const Eigen::VectorXd finite = within.cwiseAbs2().cwiseInverse();
  start.alignment = align_regularised(sources, targets, finite);
  start.determines_affine_map =
      start.alignment.determines_affine_map() || spread_like(source.vertices, start.alignment);
  const SimilarityDistance distance(source, target);
  if (start.alignment.determines_rotation()) {
    require_unmirrored_pairs(both_ways(start.alignment, sources, targets, finite, distance), anchors, within);
    return start;
  }
  const RigidTransform turn = turn_by_surfaces(start.alignment, distance);
  start.turned_by_surfaces = rotation_angle(turn) > 0;
  start.target_from_source = start.target_from_source * turn;
  Similarity& similarity = start.alignment.similarity;
  similarity = similarity * Similarity{1, turn.rotation, turn.translation};
  start.alignment.affine = {similarity.scale * similarity.rotation, similarity.translation};
  return start;
}

}  // namespace bespoke
