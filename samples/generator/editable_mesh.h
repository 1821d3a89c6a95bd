#pragma once

#include "bespoke/mesh/triangle_mesh.h"

#include <array>
#include <utility>
#include <vector>

namespace bespoke {

/// A triangle mesh whose edges can be split, collapsed and flipped. Manifold, with or without boundary; stays
/// so. Not on OpenMesh: its edits number faces otherwise, and the order of faces alone moves the maps that
/// the pages print in their third digit.
class EditableMesh {
 public:
  using Edge = std::pair<int, int>;  ///< first < second

  explicit EditableMesh(const TriangleMesh& mesh);

  TriangleMesh compacted() const;

  std::vector<Edge> edges() const;
  std::vector<int> vertices() const;
  std::vector<int> neighbours(int vertex) const;
  const std::vector<int>& faces_of(int vertex) const { return vertex_faces_[vertex]; }
  const std::array<int, 3>& face(int index) const { return faces_[index]; }
  bool has_edge(int a, int b) const;
  bool on_boundary(Edge edge) const;
  bool on_boundary(int vertex) const;

  /// The vertices opposite to the edge in its one or two faces.
  std::vector<int> opposite(Edge edge) const;

  int split(Edge edge, const Vector3& at);
  /// Whether removing `gone` into `kept` leaves a manifold of the same topology.
  bool can_collapse(int kept, int gone) const;
  void collapse(int kept, int gone);
  /// The edge between two faces becomes the edge between their opposite vertices. Precondition: can_flip.
  bool can_flip(Edge edge) const;
  void flip(Edge edge);

  std::vector<Vector3> points;

 private:
  std::vector<int> faces_with(Edge edge) const;
  void add_face(const std::array<int, 3>& face);
  void remove_face(int index);
  void replace(int face, int from, int to);

  std::vector<std::array<int, 3>> faces_;  ///< first index -1: removed
  std::vector<std::vector<int>> vertex_faces_;
};

}  // namespace bespoke
