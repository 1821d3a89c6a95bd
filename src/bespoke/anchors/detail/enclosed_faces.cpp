#include "bespoke/anchors/detail/enclosed_faces.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/equal_positions.h"
#include "bespoke/mesh/mesh_edges.h"

namespace bespoke {
namespace {

/// Of the diagonal. Lines of clicks that are a few per cent apart stay within it, a chord through a limb does
/// not.
constexpr double farthest = 0.02;
/// Of the diagonal: points of the line are projected onto the surface this near to one another where
/// neighbouring ones lie on faces without a common edge, that is at corners.
constexpr double nearest = 1e-6;
/// Of the diagonal: how far from the line a way from one point of it to the next may lead, around a corner or
/// over the rim of a groove, an eyelid for instance, that hides the surface between them.
constexpr double detour = 0.05;
/// Of the area of both sides: where the smaller has more, the inside is ambiguous.
constexpr double clearly_smaller = 0.45;

std::string place_text(const Vector3& x) {
  std::ostringstream text;
  text << '(' << x[0] << ", " << x[1] << ", " << x[2] << ')';
  return text.str();
}

/// Projects lines onto a surface, and counts how often they cross each edge.
class SurfaceWalk {
 public:
  SurfaceWalk(const TriangleMesh& mesh, const MeshEdges& edges, const std::string& where)
      : mesh_(mesh),
        edges_(edges),
        where_(where),
        tree_(mesh),
        size_(diagonal(mesh.vertices)),
        faces_of_edge_(edges.edges.size()),
        crossings_(edges.edges.size(), 0) {
    for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face)
      for (int k = 0; k < 3; ++k)
        faces_of_edge_[edge_of(static_cast<int>(face), k)].push_back(static_cast<int>(face));
  }

  void around(const Points& border) {
    const Place first = place(border.col(0));
    Place here = first;
    for (Eigen::Index i = 1; i < border.cols(); ++i) {
      const Place next = place(border.col(i));
      go(here, next);
      here = next;
    }
    go(here, first);
  }

  const std::vector<int>& crossings() const { return crossings_; }  ///< one per edge
  const std::vector<int>& faces() const { return faces_; }          ///< in their order, some repeated
  const std::vector<int>& faces_at(int edge) const { return faces_of_edge_[static_cast<std::size_t>(edge)]; }

 private:
  struct Place {
    Vector3 x;
    int face = 0;
  };

  std::size_t edge_of(int face, int k) const { return static_cast<std::size_t>(edges_.of_face(k, face)); }

  Place place(const Vector3& x) {
    const SurfacePoint foot = *tree_.closest(x);
    if (!(foot.squared_distance <= farthest * farthest * size_ * size_))
      throw InvalidInput(where_ + ": the border leaves the surface near " + place_text(x) + ", by " +
                         std::to_string(std::sqrt(foot.squared_distance)) +
                         " mesh units; give more points along it, on the surface and in the model's unit, "
                         "or the faces themselves");
    faces_.push_back(foot.face);
    return {x, foot.face};
  }

  /// Halves the way until neighbouring points are on one face or on two with a common edge.
  void go(const Place& from, const Place& to) {
    if (from.face == to.face) return;
    for (int k = 0; k < 3; ++k) {
      const std::vector<int>& faces = faces_of_edge_[edge_of(from.face, k)];
      if (std::find(faces.begin(), faces.end(), to.face) == faces.end()) continue;
      ++crossings_[edge_of(from.face, k)];
      return;
    }
    if (!((to.x - from.x).norm() > nearest * size_)) return go_around(from, to);
    const Place middle = place((from.x + to.x) / 2);
    go(from, middle);
    go(middle, to);
  }

  bool is_near(int face, const Vector3& x) const {
    const Points corners = mesh_.vertices(Eigen::all, mesh_.faces.col(face));
    return (corners.colwise() - x).colwise().norm().minCoeff() <= detour * size_;
  }

  /// The shortest way over edges: around a corner, or through a groove that the line spans.
  void go_around(const Place& from, const Place& to) {
    std::map<int, std::size_t> edge_into{{from.face, edges_.edges.size()}};
    std::map<int, int> came_from;
    std::vector<int> reached{from.face};
    for (std::size_t next = 0; next < reached.size(); ++next)
      for (int k = 0; k < 3; ++k) {
        const std::size_t edge = edge_of(reached[next], k);
        for (const int face : faces_of_edge_[edge]) {
          if (!is_near(face, to.x) || !edge_into.try_emplace(face, edge).second) continue;
          came_from[face] = reached[next];
          reached.push_back(face);
        }
      }
    if (!came_from.contains(to.face))
      throw InvalidInput(where_ + ": the border jumps near " + place_text(to.x) +
                         " to a part of the surface that is not connected there; give more points along it, "
                         "or the faces themselves");
    for (int face = to.face; face != from.face; face = came_from[face]) {
      ++crossings_[edge_into[face]];
      faces_.push_back(face);
    }
  }

  const TriangleMesh& mesh_;
  const MeshEdges& edges_;
  const std::string& where_;
  ClosestPointTree tree_;
  double size_;  // diagonal, mesh units
  std::vector<std::vector<int>> faces_of_edge_;
  std::vector<int> crossings_;
  std::vector<int> faces_;
};

/// The sides of the vertices that are connected with the line, 0 or 1; the others have none.
std::vector<std::optional<int>> sides_of_vertices(const TriangleMesh& mesh, const MeshEdges& edges,
                                                  const SurfaceWalk& walk, const std::string& where) {
  std::vector<std::optional<int>> sides(static_cast<std::size_t>(mesh.vertices.cols()));
  const auto side = [&](int vertex) -> std::optional<int>& {
    return sides[static_cast<std::size_t>(vertex)];
  };
  std::vector<char> seen(static_cast<std::size_t>(mesh.faces.cols()), 0);
  std::vector<int> faces{walk.faces().front()};
  side(mesh.faces(0, faces[0])) = 0;
  seen[static_cast<std::size_t>(faces[0])] = 1;
  bool separates = true;
  while (!faces.empty()) {
    const int face = faces.back();
    faces.pop_back();
    // Three corners in turn, twice: the first that is known may be the last.
    for (int step = 0; step < 6; ++step) {
      const int edge = edges.of_face(step % 3, face);
      const int change = walk.crossings()[static_cast<std::size_t>(edge)] % 2;
      const auto& from = side(mesh.faces(step % 3, face));
      auto& to = side(mesh.faces((step + 1) % 3, face));
      if (!from) continue;
      if (!to) to = *from ^ change;
      separates = separates && *to == (*from ^ change);
    }
    for (int k = 0; k < 3; ++k)
      for (const int next : walk.faces_at(edges.of_face(k, face)))
        if (!std::exchange(seen[static_cast<std::size_t>(next)], 1)) faces.push_back(next);
  }
  if (!separates)
    throw InvalidInput(where +
                       ": the border does not separate an inside from an outside of the surface; let it go "
                       "round the patch once, or give the faces themselves");
  return sides;
}

double area_of_face(const TriangleMesh& mesh, Eigen::Index face) {
  const Vector3 a = mesh.vertices.col(mesh.faces(0, face));
  return (mesh.vertices.col(mesh.faces(1, face)) - a)
             .cross(mesh.vertices.col(mesh.faces(2, face)) - a)
             .norm() /
         2;
}

}  // namespace

WeldedMesh welded(const TriangleMesh& mesh) {
  WeldedMesh result{{mesh.vertices, Faces(3, mesh.faces.cols())}, {}, first_at_equal_position(mesh.vertices)};
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    Eigen::Vector3i corners;
    for (int k = 0; k < 3; ++k) corners[k] = result.first_at[static_cast<std::size_t>(mesh.faces(k, face))];
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    result.mesh.faces.col(static_cast<Eigen::Index>(result.numbers.size())) = corners;
    result.numbers.push_back(static_cast<int>(face));
  }
  result.mesh.faces.conservativeResize(3, static_cast<Eigen::Index>(result.numbers.size()));
  return result;
}

EnclosedFaces enclosed_faces(const TriangleMesh& mesh, const Points& border, const std::string& where) {
  const WeldedMesh surface = welded(mesh);
  const MeshEdges edges = mesh_edges(surface.mesh);
  SurfaceWalk walk(surface.mesh, edges, where);
  walk.around(border);
  const std::vector<std::optional<int>> sides = sides_of_vertices(surface.mesh, edges, walk, where);

  std::array<std::vector<int>, 2> faces;
  std::array<double, 2> areas{0, 0};
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    std::array<int, 2> corners{0, 0};
    for (const int vertex : mesh.faces.col(face))
      if (const auto& side =
              sides[static_cast<std::size_t>(surface.first_at[static_cast<std::size_t>(vertex)])])
        ++corners[static_cast<std::size_t>(*side)];
    if (corners[0] + corners[1] == 0) continue;
    const std::size_t own = corners[0] > corners[1] ? 0 : 1;
    faces[own].push_back(static_cast<int>(face));
    areas[own] += area_of_face(mesh, face);
  }
  const std::size_t smaller = areas[0] < areas[1] ? 0 : 1;
  if (faces[smaller].empty())
    throw InvalidInput(where + ": the border encloses no face; it is smaller than the triangles there");
  if (!(areas[smaller] <= clearly_smaller * (areas[0] + areas[1])))
    throw InvalidInput(where +
                       ": the border cuts the surface in two about equal parts, and the smaller one is taken "
                       "for its inside; give the faces themselves");
  EnclosedFaces enclosed{std::move(faces[smaller]), {}};
  for (const int face : walk.faces())
    enclosed.crossed.push_back(surface.numbers[static_cast<std::size_t>(face)]);
  std::sort(enclosed.crossed.begin(), enclosed.crossed.end());
  enclosed.crossed.erase(std::unique(enclosed.crossed.begin(), enclosed.crossed.end()),
                         enclosed.crossed.end());
  return enclosed;
}

}  // namespace bespoke
