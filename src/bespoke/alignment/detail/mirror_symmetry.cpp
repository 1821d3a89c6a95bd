#include "bespoke/alignment/detail/mirror_symmetry.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bespoke/alignment/detail/similarity_search.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/rigid/rigid_alignment.h"

namespace bespoke {
namespace {

constexpr int samples = 800;  // vertices
constexpr int iterations = 15;
constexpr std::size_t starts = 3;  // planes of symmetry tried

/// After iterated closest points from `now` on; mesh units.
double distance_from(const ClosestPointTree& tree, const Points& points, Points now) {
  double squared = 0;
  for (int iteration = 0; iteration <= iterations; ++iteration) {
    Points feet(3, now.cols());
    for (Eigen::Index i = 0; i < now.cols(); ++i) feet.col(i) = tree.closest(now.col(i))->point;
    squared = (feet - now).colwise().squaredNorm().mean();
    now = align_rigidly(points, feet, Eigen::VectorXd::Ones(points.cols())) * points;
  }
  return std::sqrt(squared);
}

}  // namespace

double mirror_asymmetry(const TriangleMesh& mesh, const SurfacePatches& patches) {
  std::vector<Eigen::Index> used;
  for (std::size_t i = 0; i < patches.patch_of_vertex.size(); ++i)
    if (patches.patch_of_vertex[i] >= 0) used.push_back(static_cast<Eigen::Index>(i));
  const std::size_t stride = (used.size() + samples - 1) / samples;
  for (std::size_t k = 0; k * stride < used.size(); ++k) used[k] = used[k * stride];
  used.resize((used.size() + stride - 1) / stride);
  Points points = mesh.vertices(Eigen::all, used);
  points.row(0) *= -1;

  // A plane of symmetry is spanned by principal axes.
  const auto candidates = search_similarities(mirrored(patches), patches, axis_rotations());
  const ClosestPointTree tree(mesh);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < std::min(starts, candidates.size()); ++k)
    least = std::min(least, distance_from(tree, points, candidates[k].target_from_source * points));
  return least / patches.radius;
}

}  // namespace bespoke
