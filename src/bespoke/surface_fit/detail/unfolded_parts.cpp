#include "bespoke/surface_fit/detail/unfolded_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "bespoke/mesh/mesh_edges.h"

namespace bespoke {
namespace {

constexpr int none = MeshEdges::none;
constexpr double right_angle = std::numbers::pi / 2;

/// The edges of exactly two faces, which can bend.
class Hinges {
 public:
  explicit Hinges(const TriangleMesh& mesh)
      : edges_(mesh_edges(mesh)), sides_(edges_.edges.size(), {none, none}) {
    for (Eigen::Index face = 0; face < edges_.of_face.cols(); ++face)
      for (const int edge : edges_.of_face.col(face)) {
        if (edge == none || edges_.edges[edge].faces() != 2) continue;
        auto& [first, second] = sides_[edge];
        (first == none ? first : second) = static_cast<int>(face);
      }
  }

  std::size_t size() const { return sides_.size(); }
  const MeshEdge& edge(std::size_t hinge) const { return edges_.edges[hinge]; }
  /// Both `none` where the edge is no hinge.
  const std::array<int, 2>& faces(std::size_t hinge) const { return sides_[hinge]; }

  /// Calls visit(neighbour) for the faces beside a face.
  template <class Visit>
  void for_each_neighbour(int face, const Visit& visit) const {
    for (const int edge : edges_.of_face.col(face)) {
      if (edge == none || sides_[edge][0] == none) continue;
      visit(sides_[edge][0] == face ? sides_[edge][1] : sides_[edge][0]);
    }
  }

 private:
  MeshEdges edges_;
  std::vector<std::array<int, 2>> sides_;
};

/// One number for each face of `chosen`, the same for those connected through chosen ones; `none` elsewhere.
struct Parts {
  std::vector<int> of_face;
  int count = 0;

  Parts(const Hinges& hinges, Eigen::Index face_count, const std::vector<Eigen::Index>& chosen)
      : of_face(static_cast<std::size_t>(face_count), none) {
    constexpr int waiting = none - 1;
    for (const Eigen::Index face : chosen) of_face[face] = waiting;
    std::vector<int> open;
    for (const Eigen::Index seed : chosen) {
      if (of_face[seed] != waiting) continue;
      of_face[seed] = count;
      open.push_back(static_cast<int>(seed));
      while (!open.empty()) {
        const int face = open.back();
        open.pop_back();
        hinges.for_each_neighbour(face, [&](int neighbour) {
          if (of_face[neighbour] != waiting) return;
          of_face[neighbour] = count;
          open.push_back(neighbour);
        });
      }
      ++count;
    }
  }
};

/// How a surface is bent at its hinges.
class Bends {
 public:
  Bends(const Points& vertices, const Faces& faces)
      : vertices_(vertices), normals_(face_normals({vertices, faces})) {}

  /// Radians between the normals of a hinge's faces, negative where it is bent the other way.
  double angle(const Hinges& hinges, std::size_t hinge) const {
    const auto& [first, second] = hinges.faces(hinge);
    const MeshEdge& edge = hinges.edge(hinge);
    const Vector3 axis = (vertices_.col(edge.b) - vertices_.col(edge.a)).normalized();
    return std::atan2(axis.dot(normals_.col(first).cross(normals_.col(second))),
                      normals_.col(first).dot(normals_.col(second)));
  }

 private:
  const Points& vertices_;
  Points normals_;
};

}  // namespace

std::vector<Eigen::Index> unfolded_parts(const DrawnSurface& surface,
                                         const std::vector<Eigen::Index>& faces) {
  if (faces.empty()) return {};
  const Faces& all = surface.before.faces;
  const Hinges hinges(surface.before);
  const Parts parts(hinges, all.cols(), faces);
  const Bends shape(surface.shape, all), before(surface.before.vertices, all), after(surface.after, all);
  std::vector<char> was_folded(static_cast<std::size_t>(parts.count), 0), is_folded = was_folded;
  for (std::size_t hinge = 0; hinge < hinges.size(); ++hinge) {
    const auto& [first, second] = hinges.faces(hinge);
    if (first == none) continue;
    const int part = std::max(parts.of_face[first], parts.of_face[second]);
    if (part == none) continue;
    const double meant = shape.angle(hinges, hinge);
    const auto folds = [&](const Bends& now) {
      return std::abs(std::remainder(now.angle(hinges, hinge) - meant, 2 * std::numbers::pi)) > right_angle;
    };
    if (folds(before)) was_folded[part] = 1;
    if (folds(after)) is_folded[part] = 1;
  }
  std::vector<Eigen::Index> unfolded;
  for (const Eigen::Index face : faces)
    if (const int part = parts.of_face[face]; was_folded[part] && !is_folded[part]) unfolded.push_back(face);
  std::sort(unfolded.begin(), unfolded.end());
  return unfolded;
}

}  // namespace bespoke
