#include "bespoke/quality/self_intersection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "bespoke/mesh/box_tree.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

using Corners = std::array<Vector3, 3>;

// Sign of the volume of the tetrahedron a b c d, 0 when rounding may have decided it (Shewchuk's error bound
// of the first stage).
int side(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
  const Vector3 x = a - d, y = b - d, z = c - d;
  const auto minor = [&](int i, int j) { return y(i) * z(j) - y(j) * z(i); };
  const auto size = [&](int i, int j) { return std::abs(y(i) * z(j)) + std::abs(y(j) * z(i)); };
  const double volume = x(0) * minor(1, 2) + x(1) * minor(2, 0) + x(2) * minor(0, 1);
  const double magnitude =
      std::abs(x(0)) * size(1, 2) + std::abs(x(1)) * size(2, 0) + std::abs(x(2)) * size(0, 1);
  const double bound = (7 + 56 * std::numeric_limits<double>::epsilon()) * 0.5 *
                       std::numeric_limits<double>::epsilon() * magnitude;
  return volume > bound ? 1 : volume < -bound ? -1 : 0;
}

bool passes_through(const Vector3& p, const Vector3& q, const Corners& t) {
  const int first = side(p, q, t[0], t[1]);
  return first != 0 && side(p, q, t[1], t[2]) == first && side(p, q, t[2], t[0]) == first;
}

bool edge_passes_through(const Corners& edges, const Corners& t) {
  std::array<int, 3> sides;
  for (std::size_t k = 0; k < 3; ++k) sides[k] = side(t[0], t[1], t[2], edges[k]);
  for (std::size_t k = 0; k < 3; ++k)
    if (sides[k] * sides[(k + 1) % 3] < 0 && passes_through(edges[k], edges[(k + 1) % 3], t)) return true;
  return false;
}

Corners corners_of(const TriangleMesh& mesh, Eigen::Index face) {
  Corners corners;
  for (int k = 0; k < 3; ++k) corners[static_cast<std::size_t>(k)] = mesh.vertices.col(mesh.faces(k, face));
  return corners;
}

Box box_of(const Corners& corners) {
  Box box;
  for (const Vector3& corner : corners) box.extend(corner);
  return box;
}

bool intersect(const Corners& first, const Corners& second) {
  for (const Vector3& a : first)
    for (const Vector3& b : second)
      if (a == b) return false;
  return edge_passes_through(first, second) || edge_passes_through(second, first);
}

using Pairs = std::vector<std::pair<int, int>>;

}  // namespace

Pairs self_intersections(const TriangleMesh& mesh) { return intersections_of_first(mesh, mesh.faces.cols()); }

Pairs intersections_of_first(const TriangleMesh& mesh, Eigen::Index count) {
  std::vector<char> is_looked_at(static_cast<std::size_t>(mesh.faces.cols()), 0);
  std::fill_n(is_looked_at.begin(), std::min(count, mesh.faces.cols()), 1);
  return intersections_of(mesh, is_looked_at);
}

Pairs intersections_of(const TriangleMesh& mesh, const std::vector<char>& is_looked_at) {
  require_valid(mesh, "the mesh to intersect with itself");
  // Faces beyond the box of those that are looked at meet none of them.
  std::vector<int> looked_at, near;
  Box around;
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face)
    if (is_looked_at[static_cast<std::size_t>(face)]) {
      looked_at.push_back(static_cast<int>(face));
      around.extend(box_of(corners_of(mesh, face)));
    }
  std::vector<Corners> corners;
  std::vector<Box> boxes;
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    const Corners own = corners_of(mesh, face);
    const Box box = box_of(own);
    if (!box.intersects(around)) continue;
    near.push_back(static_cast<int>(face));
    corners.push_back(own);
    boxes.push_back(box);
  }
  if (looked_at.empty()) return {};
  const BoxTree tree = build_box_tree(boxes);
  Pairs all = parallel_reduce(
      looked_at.size(), 256, Pairs(),
      [&](std::size_t begin, std::size_t end) {
        Pairs pairs;
        for (std::size_t i = begin; i < end; ++i) {
          const int face = looked_at[i];
          const Corners own = corners_of(mesh, face);
          const Box box = box_of(own);
          for_each_overlapping(tree, box, [&](int at) {
            const int other = near[static_cast<std::size_t>(at)];
            if (other == face || (other < face && is_looked_at[static_cast<std::size_t>(other)])) return;
            if (box.intersects(boxes[static_cast<std::size_t>(at)]) &&
                intersect(own, corners[static_cast<std::size_t>(at)]))
              pairs.emplace_back(std::min(face, other), std::max(face, other));
          });
        }
        return pairs;
      },
      [](Pairs some, const Pairs& more) {
        some.insert(some.end(), more.begin(), more.end());
        return some;
      });
  std::sort(all.begin(), all.end());
  return all;
}

Pairs intersecting(const TriangleMesh& mesh, Pairs pairs) {
  std::erase_if(pairs, [&](const std::pair<int, int>& pair) {
    const Corners first = corners_of(mesh, pair.first), second = corners_of(mesh, pair.second);
    return !box_of(first).intersects(box_of(second)) || !intersect(first, second);
  });
  return pairs;
}

}  // namespace bespoke
