#include "remesh.h"

#include "editable_mesh.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace bespoke {
namespace {

class Remesher {
 public:
  Remesher(const TriangleMesh& mesh, const Field& field, const std::optional<Field>& cut,
           const RemeshOptions& options)
      : mesh_(mesh), field_(field), cut_(cut), options_(options) {
    for (const int vertex : mesh_.vertices()) approach(vertex, mesh_.points[vertex]);
  }

  TriangleMesh run() {
    for (int pass = 0; pass < options_.passes; ++pass) {
      measure_sizes();
      split_long_edges();
      collapse_short_edges();
      flip_edges();
      relax();
    }
    for (const int vertex : mesh_.vertices()) settle(vertex);
    flip_edges();
    return mesh_.compacted();
  }

 private:
  // One Newton step: enough between passes.
  void approach(int vertex, const Vector3& near) {
    if (normals_.size() < mesh_.points.size()) normals_.resize(mesh_.points.size());
    const Vector3 slope = gradient(field_, near);
    mesh_.points[vertex] = near - field_(near) * slope / std::max(slope.squaredNorm(), 0.05);
    normals_[vertex] = slope.normalized();
    if (cut_ && mesh_.on_boundary(vertex)) settle(vertex);
  }

  void settle(int vertex) {
    Vector3& point = mesh_.points[vertex];
    point = project(field_, point);
    if (cut_ && mesh_.on_boundary(vertex)) {
      for (int round = 0; round < 3; ++round) point = project(field_, project(*cut_, point));
    }
  }

  double length(EditableMesh::Edge edge) const {
    return (mesh_.points[edge.first] - mesh_.points[edge.second]).norm();
  }
  double size(EditableMesh::Edge edge) const { return std::min(sizes_[edge.first], sizes_[edge.second]); }

  // An edge of length h on a surface of curvature k sags by k h² / 8.
  void measure_sizes() {
    sizes_.assign(mesh_.points.size(), options_.coarsest);
    const std::vector<EditableMesh::Edge> edges = mesh_.edges();
    for (const auto& edge : edges) {
      const double span = std::max(length(edge), 0.5 * options_.finest);
      const double curvature = (normals_[edge.first] - normals_[edge.second]).norm() / span;
      const double wanted = std::sqrt(8 * options_.deviation / std::max(curvature, 1e-6));
      const double size = std::clamp(wanted, options_.finest, options_.coarsest);
      sizes_[edge.first] = std::min(sizes_[edge.first], size);
      sizes_[edge.second] = std::min(sizes_[edge.second], size);
    }
    // Neighbouring triangles differ little.
    const double growth = 0.3;
    for (int sweep = 0; sweep < 4; ++sweep) {
      for (const auto& edge : edges) {
        const double reach = growth * length(edge);
        sizes_[edge.first] = std::min(sizes_[edge.first], sizes_[edge.second] + reach);
        sizes_[edge.second] = std::min(sizes_[edge.second], sizes_[edge.first] + reach);
      }
    }
  }

  void split_long_edges() {
    for (const auto& edge : mesh_.edges()) {
      if (!(length(edge) > 4.0 / 3.0 * size(edge))) continue;
      const Vector3 middle = 0.5 * (mesh_.points[edge.first] + mesh_.points[edge.second]);
      const double new_size = 0.5 * (sizes_[edge.first] + sizes_[edge.second]);
      const int vertex = mesh_.split(edge, middle);
      sizes_.push_back(new_size);
      approach(vertex, middle);
    }
  }

  void collapse_short_edges() {
    for (const auto& edge : mesh_.edges()) {
      if (!mesh_.has_edge(edge.first, edge.second)) continue;
      if (!(length(edge) < 0.8 * size(edge))) continue;
      const bool keep_second = mesh_.on_boundary(edge.second) && !mesh_.on_boundary(edge.first);
      const int kept = keep_second ? edge.second : edge.first;
      const int gone = keep_second ? edge.first : edge.second;
      if (mesh_.can_collapse(kept, gone) && collapse_is_harmless(kept, gone)) mesh_.collapse(kept, gone);
    }
  }

  bool collapse_is_harmless(int kept, int gone) const {
    for (const int other : mesh_.neighbours(gone)) {
      if (other == kept) continue;
      const double after = (mesh_.points[other] - mesh_.points[kept]).norm();
      if (after > 4.0 / 3.0 * std::min(sizes_[other], sizes_[kept])) return false;
    }
    for (const int index : mesh_.faces_of(gone)) {
      std::array<int, 3> face = mesh_.face(index);
      if (std::find(face.begin(), face.end(), kept) != face.end()) continue;
      const Vector3 before = normal_of(face);
      std::replace(face.begin(), face.end(), gone, kept);
      // In a sharp crease the surface's normals at the corners say little; there the face must keep its own.
      const bool turned = !(normal_of(face).dot(before) > 0.5);
      if (turned && !faces_outward(face)) return false;
    }
    return true;
  }

  Vector3 normal_of(const std::array<int, 3>& face) const {
    const Vector3& a = mesh_.points[face[0]];
    return (mesh_.points[face[1]] - a).cross(mesh_.points[face[2]] - a).normalized();
  }

  // Whether the face looks the way the surface does at its corners.
  bool faces_outward(const std::array<int, 3>& face) const {
    const Vector3 wanted = (normals_[face[0]] + normals_[face[1]] + normals_[face[2]]).normalized();
    return normal_of(face).dot(wanted) > 0.5;
  }

  double angle(int at, int b, int c) const {
    const Vector3 to_b = mesh_.points[b] - mesh_.points[at];
    const Vector3 to_c = mesh_.points[c] - mesh_.points[at];
    return std::atan2(to_b.cross(to_c).norm(), to_b.dot(to_c));
  }

  // Delaunay: the angles opposite to an edge sum to at most 180°.
  void flip_edges() {
    const double straight = 3.14159265358979323846;
    for (int sweep = 0; sweep < 3; ++sweep) {
      for (const auto& edge : mesh_.edges()) {
        if (!mesh_.can_flip(edge)) continue;
        const std::vector<int> tips = mesh_.opposite(edge);
        const double sum = angle(tips[0], edge.first, edge.second) + angle(tips[1], edge.first, edge.second);
        if (!(sum > straight + 0.01)) continue;
        const double straight_first =
            angle(edge.first, tips[0], edge.second) + angle(edge.first, edge.second, tips[1]);
        const double straight_second =
            angle(edge.second, tips[0], edge.first) + angle(edge.second, edge.first, tips[1]);
        if (!(std::max(straight_first, straight_second) < 0.97 * straight)) continue;
        if (flip_is_harmless(edge, tips)) mesh_.flip(edge);
      }
    }
  }

  bool flip_is_harmless(EditableMesh::Edge edge, const std::vector<int>& tips) const {
    std::array<int, 3> first = {};
    for (const int index : mesh_.faces_of(edge.first)) {
      const auto& face = mesh_.face(index);
      if (std::find(face.begin(), face.end(), edge.second) == face.end()) continue;
      if (std::find(face.begin(), face.end(), tips[0]) != face.end()) first = face;
    }
    std::array<int, 3> second = first;
    std::replace(first.begin(), first.end(), edge.second, tips[1]);
    std::replace(second.begin(), second.end(), edge.first, tips[1]);
    return faces_outward(first) && faces_outward(second);
  }

  void relax() {
    const double share = 0.6;
    for (const int vertex : mesh_.vertices()) {
      const bool boundary = mesh_.on_boundary(vertex);
      Vector3 sum = Vector3::Zero();
      double total = 0;
      for (const int other : mesh_.neighbours(vertex)) {
        if (boundary && !mesh_.on_boundary(EditableMesh::Edge(std::minmax(vertex, other)))) continue;
        const double weight = 1 / sizes_[other];
        sum += weight * mesh_.points[other];
        total += weight;
      }
      Vector3 step = share * (sum / total - mesh_.points[vertex]);
      step -= step.dot(normals_[vertex]) * normals_[vertex];
      approach(vertex, mesh_.points[vertex] + step);
    }
  }

  EditableMesh mesh_;
  const Field& field_;
  const std::optional<Field>& cut_;
  const RemeshOptions& options_;
  std::vector<Vector3> normals_;  // per vertex, of the field
  std::vector<double> sizes_;     // per vertex, wanted edge length, cm
};

}  // namespace

TriangleMesh remesh(const TriangleMesh& mesh, const Field& field, const std::optional<Field>& cut,
                    const RemeshOptions& options) {
  return Remesher(mesh, field, cut, options).run();
}

}  // namespace bespoke
