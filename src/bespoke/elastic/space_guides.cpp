#include "bespoke/elastic/space_guides.h"

#include <optional>
#include <string>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/mesh_edges.h"
#include "bespoke/parallel.h"
#include "bespoke/rbf/point_grid.h"
#include "bespoke/rigid/nearest_rotation.h"

namespace bespoke {
namespace {

// Of λ. A layer's centres are λ/4 apart, so that guides of the first layer must be farther from its centres
// on the surface.
constexpr double offset_share = 0.4;
constexpr double min_clearance = 0.9;  // offsets: nearer to a surface is nearer to another part
// Factor by which guides may part or approach each other (tests/accuracy/tuning.md).
constexpr double max_strain = 2;

struct Guide {
  Vector3 source, target;
};

class Guiding {
 public:
  Guiding(const TriangleMesh& source, const Points& fitted)
      : source_(source),
        fitted_(fitted),
        scale_(growth(source, fitted)),
        normals_(vertex_normals(source)),
        areas_(vertex_areas(source)),
        ring_(vertex_adjacency(source)),
        here_(source),
        there_({fitted, source.faces}) {}

  SpaceGuides at(double distance) const {
    const PointGrid grid(source_.vertices, distance);
    const std::vector<int> chosen = thin_points(source_.vertices, distance / 2);
    std::vector<std::optional<Guide>> found(chosen.size());
    constexpr std::size_t grain = 16;
    parallel_for(chosen.size(), grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) found[k] = guide(grid, chosen[k], distance);
    });
    std::erase(found, std::nullopt);
    const auto count = static_cast<Eigen::Index>(found.size());
    SpaceGuides guides{Points(3, count), Points(3, count), distance};
    for (Eigen::Index k = 0; k < count; ++k) {
      guides.sources.col(k) = found[static_cast<std::size_t>(k)]->source;
      guides.targets.col(k) = found[static_cast<std::size_t>(k)]->target;
    }
    return those_in_accord(guides);
  }

 private:
  /// Without those that some other, near before or after, would squeeze or stretch the space between.
  SpaceGuides those_in_accord(const SpaceGuides& guides) const {
    const Points targets = guides.targets / scale_;
    const PointGrid before(guides.sources, guides.offset), after(targets, guides.offset);
    std::vector<Eigen::Index> kept;
    for (Eigen::Index k = 0; k < targets.cols(); ++k) {
      bool is_in_accord = true;
      const auto compare = [&](Eigen::Index other, double) {
        const double source = (guides.sources.col(other) - guides.sources.col(k)).norm();
        const double target = (targets.col(other) - targets.col(k)).norm();
        if (target > max_strain * source || source > max_strain * target) is_in_accord = false;
      };
      before.for_each_within(guides.sources.col(k), guides.offset, compare);
      after.for_each_within(targets.col(k), guides.offset, compare);
      if (is_in_accord) kept.push_back(k);
    }
    return {guides.sources(Eigen::all, kept), guides.targets(Eigen::all, kept), guides.offset};
  }

  std::optional<Guide> guide(const PointGrid& grid, int vertex, double distance) const {
    std::vector<int> around;
    Vector3 normal = Vector3::Zero(), from = Vector3::Zero(), to = Vector3::Zero();
    double area = 0;
    const auto take = [&](int other) {
      if (!(normals_.col(other).dot(normals_.col(vertex)) > 0)) return;
      around.push_back(other);
      area += areas_[other];
      normal += areas_[other] * normals_.col(other);
      from += areas_[other] * source_.vertices.col(other);
      to += areas_[other] * fitted_.col(other);
    };
    const Vector3 here = source_.vertices.col(vertex);
    grid.for_each_within(here, distance, [&](int other, double) { take(other); });
    for (int k = ring_.start[vertex]; k < ring_.start[vertex + 1]; ++k) {
      const int other = ring_.neighbours[k];
      if ((source_.vertices.col(other) - here).squaredNorm() > distance * distance) take(other);
    }
    if (around.size() < 3 || !(area > 0 && normal.norm() > 0)) return std::nullopt;  // no rotation
    from /= area;
    to /= area;
    Matrix3 covariance = Matrix3::Zero();
    for (const int other : around)
      covariance +=
          areas_[other] * (fitted_.col(other) - to) * (source_.vertices.col(other) - from).transpose();
    const Vector3 arm = distance * normal.normalized();
    const Guide guide{here + arm,
                      fitted_.col(vertex) + scale_ * (nearest_rotation(covariance).rotation * arm)};
    if (here_.closest(guide.source, {.max_distance = min_clearance * distance}) ||
        there_.closest(guide.target, {.max_distance = min_clearance * scale_ * distance}))
      return std::nullopt;
    return guide;
  }

  const TriangleMesh& source_;
  const Points& fitted_;
  double scale_;
  Points normals_;
  Eigen::VectorXd areas_;
  VertexAdjacency ring_;
  ClosestPointTree here_, there_;
};

}  // namespace

SpaceGuides space_guides(const TriangleMesh& source, const Points& fitted, double lambda) {
  if (fitted.cols() != source.vertices.cols() || !(lambda > 0))
    throw InvalidInput("space_guides got " + std::to_string(fitted.cols()) + " fitted vertices of " +
                       std::to_string(source.vertices.cols()) + " and lambda " + std::to_string(lambda));
  return Guiding(source, fitted).at(offset_share * lambda);
}

}  // namespace bespoke
