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

class FaceBoxes {
 public:
  explicit FaceBoxes(const TriangleMesh& mesh)
      : boxes(static_cast<std::size_t>(mesh.faces.cols())), corners(boxes.size()) {
    for (std::size_t face = 0; face < boxes.size(); ++face)
      for (int k = 0; k < 3; ++k) {
        corners[face][static_cast<std::size_t>(k)] =
            mesh.vertices.col(mesh.faces(k, static_cast<Eigen::Index>(face)));
        boxes[face].extend(corners[face][static_cast<std::size_t>(k)]);
      }
  }

  bool intersect(std::size_t i, std::size_t j) const {
    if (!boxes[i].intersects(boxes[j])) return false;
    for (const Vector3& a : corners[i])
      for (const Vector3& b : corners[j])
        if (a == b) return false;
    return edge_passes_through(corners[i], corners[j]) || edge_passes_through(corners[j], corners[i]);
  }

  std::vector<Box> boxes;
  std::vector<Corners> corners;
};

}  // namespace

std::vector<std::pair<int, int>> self_intersections(const TriangleMesh& mesh) {
  return intersections_of_first(mesh, mesh.faces.cols());
}

std::vector<std::pair<int, int>> intersections_of_first(const TriangleMesh& mesh, Eigen::Index count) {
  require_valid(mesh, "the mesh to intersect with itself");
  const FaceBoxes faces(mesh);
  const BoxTree tree = build_box_tree(faces.boxes);
  using Pairs = std::vector<std::pair<int, int>>;
  return parallel_reduce(
      static_cast<std::size_t>(std::min(count, mesh.faces.cols())), 256, Pairs(),
      [&](std::size_t begin, std::size_t end) {
        Pairs pairs;
        for (std::size_t i = begin; i < end; ++i) {
          const auto first = static_cast<std::ptrdiff_t>(pairs.size());
          for_each_overlapping(tree, faces.boxes[i], [&](int j) {
            if (static_cast<std::size_t>(j) > i && faces.intersect(i, static_cast<std::size_t>(j)))
              pairs.emplace_back(static_cast<int>(i), j);
          });
          std::sort(pairs.begin() + first, pairs.end());
        }
        return pairs;
      },
      [](Pairs all, const Pairs& more) {
        all.insert(all.end(), more.begin(), more.end());
        return all;
      });
}

}  // namespace bespoke
