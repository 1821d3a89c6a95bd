#include "editable_mesh.h"

#include <algorithm>
#include <cassert>

namespace bespoke {
namespace {

constexpr int removed = -1;

bool contains(const std::array<int, 3>& face, int vertex) {
  return face[0] == vertex || face[1] == vertex || face[2] == vertex;
}

int third(const std::array<int, 3>& face, EditableMesh::Edge edge) {
  for (const int vertex : face) {
    if (vertex != edge.first && vertex != edge.second) return vertex;
  }
  assert(false);
  return removed;
}

}  // namespace

EditableMesh::EditableMesh(const TriangleMesh& mesh) : vertex_faces_(mesh.vertices.cols()) {
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i) points.push_back(mesh.vertices.col(i));
  for (Eigen::Index i = 0; i < mesh.faces.cols(); ++i) {
    add_face({mesh.faces(0, i), mesh.faces(1, i), mesh.faces(2, i)});
  }
}

TriangleMesh EditableMesh::compacted() const {
  const std::vector<int> used = vertices();
  std::vector<int> index(points.size(), removed);
  TriangleMesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(used.size()));
  for (std::size_t i = 0; i < used.size(); ++i) {
    index[used[i]] = static_cast<int>(i);
    mesh.vertices.col(static_cast<Eigen::Index>(i)) = points[used[i]];
  }
  const auto alive =
      std::count_if(faces_.begin(), faces_.end(), [](const auto& face) { return face[0] != removed; });
  mesh.faces.resize(3, alive);
  Eigen::Index column = 0;
  for (const auto& face : faces_) {
    if (face[0] == removed) continue;
    mesh.faces.col(column++) << index[face[0]], index[face[1]], index[face[2]];
  }
  return mesh;
}

std::vector<EditableMesh::Edge> EditableMesh::edges() const {
  std::vector<Edge> all;
  for (const auto& face : faces_) {
    if (face[0] == removed) continue;
    for (int i = 0; i < 3; ++i) all.push_back(std::minmax(face[i], face[(i + 1) % 3]));
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

std::vector<int> EditableMesh::vertices() const {
  std::vector<int> used;
  for (std::size_t i = 0; i < vertex_faces_.size(); ++i) {
    if (!vertex_faces_[i].empty()) used.push_back(static_cast<int>(i));
  }
  return used;
}

std::vector<int> EditableMesh::neighbours(int vertex) const {
  std::vector<int> around;
  for (const int face : vertex_faces_[vertex]) {
    for (const int other : faces_[face]) {
      if (other != vertex && std::find(around.begin(), around.end(), other) == around.end())
        around.push_back(other);
    }
  }
  return around;
}

bool EditableMesh::has_edge(int a, int b) const { return !faces_with({a, b}).empty(); }

bool EditableMesh::on_boundary(Edge edge) const { return faces_with(edge).size() == 1; }

bool EditableMesh::on_boundary(int vertex) const {
  return neighbours(vertex).size() != vertex_faces_[vertex].size();
}

std::vector<int> EditableMesh::opposite(Edge edge) const {
  std::vector<int> found;
  for (const int face : faces_with(edge)) found.push_back(third(faces_[face], edge));
  return found;
}

int EditableMesh::split(Edge edge, const Vector3& at) {
  const int middle = static_cast<int>(points.size());
  points.push_back(at);
  vertex_faces_.emplace_back();
  for (const int face : faces_with(edge)) {
    std::array<int, 3> second = faces_[face];
    std::replace(second.begin(), second.end(), edge.first, middle);
    replace(face, edge.second, middle);
    add_face(second);
  }
  return middle;
}

bool EditableMesh::can_collapse(int kept, int gone) const {
  const std::size_t shared_faces = faces_with({kept, gone}).size();
  if (shared_faces == 0) return false;
  if (on_boundary(gone) && shared_faces != 1) return false;
  const std::vector<int> around = neighbours(gone);
  const std::vector<int> around_kept = neighbours(kept);
  const auto common = std::count_if(around.begin(), around.end(), [&](int vertex) {
    return std::find(around_kept.begin(), around_kept.end(), vertex) != around_kept.end();
  });
  if (static_cast<std::size_t>(common) != shared_faces) return false;
  // The tips of the vanishing faces lose an edge each.
  for (const int tip : opposite({kept, gone})) {
    if (vertex_faces_[tip].size() <= (on_boundary(tip) ? 2u : 3u)) return false;
  }
  return true;
}

void EditableMesh::collapse(int kept, int gone) {
  for (const int face : faces_with({kept, gone})) remove_face(face);
  const std::vector<int> moved = vertex_faces_[gone];
  for (const int face : moved) replace(face, gone, kept);
}

bool EditableMesh::can_flip(Edge edge) const {
  const std::vector<int> tips = opposite(edge);
  return tips.size() == 2 && tips[0] != tips[1] && !has_edge(tips[0], tips[1]);
}

void EditableMesh::flip(Edge edge) {
  const std::vector<int> faces = faces_with(edge);
  const int first_tip = third(faces_[faces[0]], edge);
  const int second_tip = third(faces_[faces[1]], edge);
  replace(faces[0], edge.second, second_tip);
  replace(faces[1], edge.first, first_tip);
}

std::vector<int> EditableMesh::faces_with(Edge edge) const {
  std::vector<int> found;
  for (const int face : vertex_faces_[edge.first]) {
    if (contains(faces_[face], edge.second)) found.push_back(face);
  }
  return found;
}

void EditableMesh::add_face(const std::array<int, 3>& face) {
  for (const int vertex : face) vertex_faces_[vertex].push_back(static_cast<int>(faces_.size()));
  faces_.push_back(face);
}

void EditableMesh::remove_face(int index) {
  for (const int vertex : faces_[index]) std::erase(vertex_faces_[vertex], index);
  faces_[index] = {removed, removed, removed};
}

void EditableMesh::replace(int face, int from, int to) {
  std::replace(faces_[face].begin(), faces_[face].end(), from, to);
  std::erase(vertex_faces_[from], face);
  vertex_faces_[to].push_back(face);
}

}  // namespace bespoke
