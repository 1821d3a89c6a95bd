#include "bespoke/surface_fit/detail/misoriented_faces.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "bespoke/mesh/disjoint_sets.h"
#include "bespoke/mesh/mesh_edges.h"
#include "bespoke/surface_fit/detail/bends.h"
#include "bespoke/surface_fit/matching/harmonic_extension.h"

namespace bespoke {
namespace {

/// Radians; 0 where a direction is zero.
double angle(const Vector3& a, const Vector3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

/// Products of a face's edges at its first corner.
Eigen::Matrix2d face_metric(const Faces& faces, Eigen::Index face, const Points& vertices) {
  Eigen::Matrix<double, 3, 2> edges;
  for (int k = 0; k < 2; ++k) edges.col(k) = vertices.col(faces(k + 1, face)) - vertices.col(faces(0, face));
  return edges.transpose() * edges;
}

/// How the faces of a surface lie, and how the surface around each does.
struct FaceNormals {
  Points own;     // 3×m, unit; zero for a face without area
  Points around;  // 3×m, sums of the corners' normals

  explicit FaceNormals(const TriangleMesh& mesh)
      : own(face_normals(mesh)), around(Points::Zero(3, mesh.faces.cols())) {
    const Points corners = vertex_normals(mesh, own);
    for (Eigen::Index face = 0; face < around.cols(); ++face)
      for (const int vertex : mesh.faces.col(face)) around.col(face) += corners.col(vertex);
  }

  bool has_area(Eigen::Index face) const { return own.col(face).squaredNorm() > 0; }
  /// Angle between a face and the surface around it.
  double crease(Eigen::Index face) const { return angle(own.col(face), around.col(face)); }
};

/// Edges at which the faces are bent by more than a right angle.
std::vector<char> folded_edges(const std::vector<Hinge>& edges, const Points& normals) {
  std::vector<char> folded(edges.size());
  for (std::size_t k = 0; k < edges.size(); ++k)
    folded[k] = normals.col(edges[k].first).dot(normals.col(edges[k].second)) < 0;
  return folded;
}

/// What became of a surface, face by face.
class FaceChanges {
 public:
  FaceChanges(const DrawnSurface& surface, const std::vector<Hinge>& edges,
              const FaceRepairSettings& settings)
      : before_(surface.before),
        normals_(surface.before),
        edges_(edges),
        folded_shape_(folded_edges(edges, face_normals({surface.shape, surface.before.faces}))),
        max_turned_(settings.max_degrees * std::numbers::pi / 180),
        max_stretch_(settings.max_stretch) {}

  struct Bad {
    std::vector<Eigen::Index> turned, folded, stretched;  // a face is in the first that it could be in
    std::size_t size() const { return turned.size() + folded.size() + stretched.size(); }
    bool empty() const { return size() == 0; }
    std::vector<Eigen::Index> all() const {
      std::vector<Eigen::Index> faces = turned;
      faces.insert(faces.end(), folded.begin(), folded.end());
      faces.insert(faces.end(), stretched.begin(), stretched.end());
      return faces;
    }
  };

  /// A face without area has not turned.
  Bad bad(const Points& after) const {
    const FaceNormals normals({after, before_.faces});
    const std::vector<char> is_folded = at_new_folds(normals.own);
    Bad found;
    for (Eigen::Index face = 0; face < before_.faces.cols(); ++face) {
      if (normals.has_area(face) && normals_.has_area(face) && turn(normals, face) > max_turned_)
        found.turned.push_back(face);
      else if (is_folded[face])
        found.folded.push_back(face);
      else if (face_stretch(before_.faces, face, before_.vertices, after) > max_stretch_)
        found.stretched.push_back(face);
    }
    return found;
  }

 private:
  /// Faces at edges that are folded now and are not in the shape.
  std::vector<char> at_new_folds(const Points& normals) const {
    const std::vector<char> folded = folded_edges(edges_, normals);
    std::vector<char> faces(static_cast<std::size_t>(before_.faces.cols()), 0);
    for (std::size_t k = 0; k < edges_.size(); ++k)
      if (folded[k] && !folded_shape_[k]) faces[edges_[k].first] = faces[edges_[k].second] = 1;
    return faces;
  }

  /// Radians. A face that stood off the surface around it turns as that is smoothed, over no fold.
  double turn(const FaceNormals& after, Eigen::Index face) const {
    const double smoothed = std::max(0.0, normals_.crease(face) - after.crease(face));
    return angle(after.own.col(face), normals_.own.col(face)) - smoothed;
  }

  const TriangleMesh& before_;
  FaceNormals normals_;
  const std::vector<Hinge>& edges_;
  std::vector<char> folded_shape_;
  double max_turned_, max_stretch_;
};

/// The faces' corners and the vertices at most `rings` edges away from one.
std::vector<int> around(const TriangleMesh& mesh, const VertexAdjacency& adjacency,
                        const std::vector<Eigen::Index>& faces, int rings) {
  std::vector<int> patch;
  std::vector<char> in_patch(static_cast<std::size_t>(mesh.vertices.cols()), 0);
  const auto add = [&](int vertex) {
    if (!std::exchange(in_patch[vertex], 1)) patch.push_back(vertex);
  };
  for (const Eigen::Index face : faces)
    for (const int vertex : mesh.faces.col(face)) add(vertex);
  std::size_t begin = 0;
  for (int ring = 0; ring < rings; ++ring)
    for (const std::size_t end = patch.size(); begin < end; ++begin)
      for (int k = adjacency.start[patch[begin]]; k < adjacency.start[patch[begin] + 1]; ++k)
        add(adjacency.neighbours[k]);
  return patch;
}

/// The corners of the faces that were released, by index.
std::vector<int> released_corners(const TriangleMesh& mesh, const std::vector<Eigen::Index>& faces,
                                  std::vector<int> released) {
  std::set<int> corners;
  for (const Eigen::Index face : faces)
    for (const int vertex : mesh.faces.col(face)) corners.insert(vertex);
  std::sort(released.begin(), released.end());
  std::erase_if(released, [&](int vertex) { return !corners.contains(vertex); });
  return released;
}

/// Of the free vertices, those of patches that are bent no farther from their shape as repaired than as
/// drawn. A patch is connected along edges, and its faces are those with a corner in it.
std::vector<int> no_farther_bent(const DrawnSurface& surface, const std::vector<Hinge>& edges,
                                 const Points& repaired, std::vector<int> free) {
  if (free.empty()) return free;
  constexpr int none = -1;
  constexpr double rounding = 1e-9;  // squared radians
  const Faces& faces = surface.before.faces;
  std::vector<char> is_free(static_cast<std::size_t>(repaired.cols()), 0);
  for (const int vertex : free) is_free[vertex] = 1;
  DisjointSets patches(static_cast<int>(is_free.size()));
  std::vector<int> free_corner(static_cast<std::size_t>(faces.cols()), none);
  for (Eigen::Index face = 0; face < faces.cols(); ++face)
    for (const int vertex : faces.col(face)) {
      if (!is_free[vertex]) continue;
      if (free_corner[face] == none) free_corner[face] = vertex;
      patches.join(vertex, free_corner[face]);
    }

  const std::vector<double> drawn_bends = bends(edges, faces, surface.shape, surface.after);
  const std::vector<double> repaired_bends = bends(edges, faces, surface.shape, repaired);
  std::vector<double> growth(is_free.size(), 0.0);  // of a patch, by its least vertex
  for (std::size_t k = 0; k < edges.size(); ++k) {
    const int first = free_corner[edges[k].first], second = free_corner[edges[k].second];
    const double grown = repaired_bends[k] * repaired_bends[k] - drawn_bends[k] * drawn_bends[k];
    if (first != none) growth[patches.least(first)] += grown;
    if (second != none && (first == none || patches.least(second) != patches.least(first)))
      growth[patches.least(second)] += grown;
  }
  std::erase_if(free, [&](int vertex) { return growth[patches.least(vertex)] > rounding; });
  return free;
}

}  // namespace

double face_stretch(const Faces& faces, Eigen::Index face, const Points& before, const Points& after) {
  constexpr double tiny = 1e-300;
  const Eigen::Matrix2d from = face_metric(faces, face, before), to = face_metric(faces, face, after);
  if (!(from.determinant() > 0)) return 1;
  // Squared factors are the eigenvalues of from⁻¹ to.
  const Eigen::Matrix2d squared = from.inverse() * to;
  const double half = squared.trace() / 2, product = squared.determinant();
  const double largest = half + std::sqrt(std::max(0.0, half * half - product));
  return std::sqrt(std::max(largest, largest / std::max(product, tiny)));
}

RepairedSurface repair_misoriented_faces(const DrawnSurface& surface, const FaceRepairSettings& settings) {
  const TriangleMesh& before = surface.before;
  const Points& after = surface.after;
  const std::vector<Hinge> edges = hinges(before);
  const FaceChanges changes(surface, edges, settings);
  const VertexAdjacency adjacency = vertex_adjacency(before);
  const FaceChanges::Bad drawn = changes.bad(after);
  const auto max_free = std::max(settings.released_at_least,
                                 static_cast<std::size_t>(settings.max_released * double(after.cols())));
  Points best = after;
  std::size_t best_free = 0, fewest = drawn.size();
  std::vector<char> is_free(static_cast<std::size_t>(after.cols()), 0);
  std::vector<int> free;
  FaceChanges::Bad bad = drawn;
  for (int rings = 0; rings < settings.max_rings && !bad.empty(); ++rings) {
    std::vector<int> released;
    for (const int vertex : around(before, adjacency, bad.all(), rings))
      if (!is_free[vertex]) released.push_back(vertex);
    if (free.size() + released.size() > max_free) break;
    for (const int vertex : released) is_free[vertex] = 1;
    free.insert(free.end(), released.begin(), released.end());
    Points repaired =
        before.vertices + extend_harmonically(before.vertices, adjacency, free, after - before.vertices);
    bad = changes.bad(repaired);
    // More rings than help would only undo more of the fit.
    if (bad.size() >= fewest) continue;
    fewest = bad.size();
    best = std::move(repaired);
    best_free = free.size();
  }
  free.resize(best_free);
  free = no_farther_bent(surface, edges, best, std::move(free));
  RepairedSurface result{after, free.size(), {}, 0};
  for (const int vertex : free) result.vertices.col(vertex) = best.col(vertex);
  result.misoriented_faces = changes.bad(result.vertices).turned.size();
  result.stretched_vertices = released_corners(before, drawn.stretched, std::move(free));
  return result;
}

}  // namespace bespoke
