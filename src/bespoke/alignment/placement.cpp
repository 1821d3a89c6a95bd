#include "bespoke/alignment/placement.h"

#include <cmath>
#include <string>
#include <vector>

#include "bespoke/alignment/detail/patch_deformation.h"
#include "bespoke/alignment/detail/surface_patches.h"
#include "bespoke/error.h"
#include "bespoke/mesh/cavities.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/parallel.h"
#include "bespoke/topology/edge_refinement.h"

namespace bespoke {
namespace {

constexpr int patches = 600;        // as the alignment deforms
constexpr double reach = 0.01;      // of the target's diagonal: farther parts were not found
constexpr std::size_t grain = 256;  // vertices

/// n: distances of points from a surface, mesh units.
Eigen::VectorXd distances_from(const TriangleMesh& surface, const Points& points) {
  const ClosestPointTree tree(surface);
  Eigen::VectorXd distances(points.cols());
  parallel_for(static_cast<std::size_t>(points.cols()), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      distances[i] = std::sqrt(tree.closest(points.col(i))->squared_distance);
    }
  });
  return distances;
}

/// n: what each vertex that lies in the open represents, mesh units squared.
Eigen::VectorXd open_areas(const TriangleMesh& mesh, const std::vector<char>& in_cavity) {
  Eigen::VectorXd areas = vertex_areas(mesh);
  for (std::size_t i = 0; i < in_cavity.size(); ++i)
    if (in_cavity[i]) areas[static_cast<Eigen::Index>(i)] = 0;
  return areas;
}

double distortion_of(const TriangleMesh& source, const Points& placed) {
  const RefinedMesh fine = refine_long_edges(source, longest_edge_of_patches(source, patches));
  Points fine_placed(3, fine.mesh.vertices.cols());
  fine_placed.leftCols(placed.cols()) = placed;
  for (Eigen::Index k = 0; k < fine.parents.cols(); ++k)
    fine_placed.col(placed.cols() + k) =
        (fine_placed.col(fine.parents(0, k)) + fine_placed.col(fine.parents(1, k))) / 2;
  return distortion(fine.mesh, make_surface_patches(fine.mesh, patches), fine_placed);
}

}  // namespace

PlacementScore::PlacementScore(const TriangleMesh& source, const TriangleMesh& target)
    : source_(source),
      target_(target),
      source_in_cavity_(cavities_of(source).contains),
      target_areas_(open_areas(target, cavities_of(target).contains)) {}

PlacementFigures PlacementScore::operator()(const Points& placed) const {
  if (placed.cols() != source_.vertices.cols())
    throw InvalidInput(std::to_string(placed.cols()) + " places for " +
                       std::to_string(source_.vertices.cols()) + " vertices");
  const TriangleMesh moved{placed, source_.faces};
  const Eigen::VectorXd areas = open_areas(moved, source_in_cavity_);
  const Eigen::VectorXd there = distances_from(target_, placed);
  const Eigen::VectorXd back = distances_from(moved, target_.vertices);
  const double unit = diagonal(target_.vertices);
  PlacementFigures figures;
  figures.distance =
      (there.dot(areas) / areas.sum() + back.dot(target_areas_) / target_areas_.sum()) / 2 / unit;
  const Eigen::VectorXd near = (back.array() <= reach * unit).cast<double>();
  figures.covered = near.dot(target_areas_) / target_areas_.sum();
  figures.distortion = distortion_of(source_, placed);
  return figures;
}

}  // namespace bespoke
