#include "bespoke/surface_fit/detail/correspondence.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

std::vector<char> boundary_edges(const Faces& faces) {
  struct Side {
    std::pair<int, int> edge;  // lower vertex first
    Eigen::Index face;
    int corner;  // the one opposite
  };
  std::vector<Side> sides;
  sides.reserve(static_cast<std::size_t>(faces.size()));
  for (Eigen::Index face = 0; face < faces.cols(); ++face)
    for (int corner = 0; corner < 3; ++corner) {
      const auto ends = std::minmax({faces((corner + 1) % 3, face), faces((corner + 2) % 3, face)});
      sides.push_back({ends, face, corner});
    }
  std::stable_sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.edge < b.edge; });
  std::vector<char> bits(static_cast<std::size_t>(faces.cols()), 0);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const bool as_before = i > 0 && sides[i - 1].edge == sides[i].edge;
    const bool as_after = i + 1 < sides.size() && sides[i + 1].edge == sides[i].edge;
    if (!as_before && !as_after)
      bits[static_cast<std::size_t>(sides[i].face)] |= static_cast<char>(1 << sides[i].corner);
  }
  return bits;
}

}  // namespace

CompatiblePoints::CompatiblePoints(const TriangleMesh& target)
    : tree_(target),
      faces_(target.faces),
      boundary_edges_(boundary_edges(target.faces)),
      boundary_vertices_(bespoke::boundary_vertices(target)) {}

bool CompatiblePoints::on_boundary(const SurfacePoint& found) const {
  // Far below what a vertex can be told apart by, far above the rounding of the projection onto an edge.
  constexpr double zero_weight = 1e-9;
  std::array<int, 3> outside{};
  int count = 0;
  for (int corner = 0; corner < 3; ++corner)
    if (found.barycentric[corner] <= zero_weight) outside[static_cast<std::size_t>(count++)] = corner;
  if (count == 1) return boundary_edges_[static_cast<std::size_t>(found.face)] >> outside[0] & 1;
  if (count == 2) {
    const int corner = 3 - outside[0] - outside[1];
    return boundary_vertices_[static_cast<std::size_t>(faces_(corner, found.face))];
  }
  return false;
}

Correspondence CompatiblePoints::closest(const Points& vertices, const Points& normals) const {
  if (vertices.cols() != normals.cols())
    throw InvalidInput(std::to_string(vertices.cols()) + " vertices, but " + std::to_string(normals.cols()) +
                       " normals");
  const auto count = static_cast<std::size_t>(vertices.cols());
  Correspondence result{vertices, std::vector<char>(count, 0), 0};
  parallel_for(count, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      ClosestPointQuery query;
      query.normal = normals.col(column);
      if (!(query.normal->squaredNorm() > 0)) continue;
      const auto found = tree_.closest(vertices.col(column), query);
      if (!found || on_boundary(*found)) continue;
      result.points.col(column) = found->point;
      result.matched[i] = 1;
    }
  });
  result.unmatched = static_cast<std::size_t>(std::count(result.matched.begin(), result.matched.end(), 0));
  return result;
}

}  // namespace bespoke
