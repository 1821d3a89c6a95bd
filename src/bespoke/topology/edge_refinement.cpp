#include "bespoke/topology/edge_refinement.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/mesh/mesh_edges.h"

namespace bespoke {
namespace {

struct Refinement {
  TriangleMesh mesh;
  std::vector<Eigen::Vector2i> parents;
  std::vector<int> origins;
};

/// The edges of a face turned such that one halved edge comes first, or the whole one of three last.
int first_edge(const std::array<bool, 3>& halved) {
  const auto count = std::count(halved.begin(), halved.end(), true);
  std::size_t first = 0;
  while (count == 1 && !halved[first]) ++first;
  while (count == 2 && halved[(first + 2) % 3]) ++first;
  return static_cast<int>(first);
}

/// The face, cut at the middles of its edges; middle[k] lies between corners k and k + 1.
void append_parts(const Eigen::Vector3i& face, const std::array<std::optional<int>, 3>& middle,
                  std::vector<Eigen::Vector3i>& parts) {
  const std::array<bool, 3> halved{middle[0].has_value(), middle[1].has_value(), middle[2].has_value()};
  const int first = first_edge(halved), second = (first + 1) % 3, third = (first + 2) % 3;
  const int a = face[first], b = face[second], c = face[third];
  const auto ab = middle[static_cast<std::size_t>(first)], bc = middle[static_cast<std::size_t>(second)],
             ca = middle[static_cast<std::size_t>(third)];
  if (!ab) {
    parts.push_back(face);
  } else if (!bc) {
    parts.insert(parts.end(), {{a, *ab, c}, {*ab, b, c}});
  } else if (!ca) {
    parts.insert(parts.end(), {{*ab, b, *bc}, {a, *ab, *bc}, {a, *bc, c}});
  } else {
    parts.insert(parts.end(), {{a, *ab, *ca}, {*ab, b, *bc}, {*ca, *bc, c}, {*ab, *bc, *ca}});
  }
}

Faces as_faces(const std::vector<Eigen::Vector3i>& parts) {
  Faces faces(3, static_cast<Eigen::Index>(parts.size()));
  for (std::size_t i = 0; i < parts.size(); ++i) faces.col(static_cast<Eigen::Index>(i)) = parts[i];
  return faces;
}

/// Midpoints of the long edges of this round; false when there are none.
bool halve_long_edges(Refinement& state, double max_length) {
  const Points& vertices = state.mesh.vertices;
  const MeshEdges table = mesh_edges(state.mesh);
  std::vector<std::optional<int>> midpoint(table.edges.size());
  std::vector<Vector3> added;
  std::vector<Eigen::Vector3i> parts;
  std::vector<int> origins;
  parts.reserve(static_cast<std::size_t>(state.mesh.faces.cols()) * 2);
  for (Eigen::Index column = 0; column < state.mesh.faces.cols(); ++column) {
    const Eigen::Vector3i face = state.mesh.faces.col(column);
    std::array<std::optional<int>, 3> middle;
    for (int k = 0; k < 3; ++k) {
      const int edge = table.of_face(k, column), a = face[k], b = face[(k + 1) % 3];
      if (edge == MeshEdges::none || !((vertices.col(a) - vertices.col(b)).norm() > max_length)) continue;
      std::optional<int>& made = midpoint[static_cast<std::size_t>(edge)];
      if (!made) {
        made = static_cast<int>(vertices.cols()) + static_cast<int>(added.size());
        added.emplace_back((vertices.col(a) + vertices.col(b)) / 2);
        state.parents.emplace_back(a, b);
      }
      middle[static_cast<std::size_t>(k)] = made;
    }
    append_parts(face, middle, parts);
    origins.resize(parts.size(), state.origins[static_cast<std::size_t>(column)]);
  }
  if (added.empty()) return false;
  const Eigen::Index before = vertices.cols();
  state.mesh.vertices.conservativeResize(3, before + static_cast<Eigen::Index>(added.size()));
  for (std::size_t i = 0; i < added.size(); ++i)
    state.mesh.vertices.col(before + static_cast<Eigen::Index>(i)) = added[i];
  state.mesh.faces = as_faces(parts);
  state.origins = std::move(origins);
  return true;
}

}  // namespace

RefinedMesh refine_long_edges(const TriangleMesh& mesh, double max_length, int max_passes) {
  if (!(max_length > 0))
    throw InvalidInput("edges cannot be refined to a length of " + std::to_string(max_length) +
                       "; it must be positive");
  Refinement state{mesh, {}, std::vector<int>(static_cast<std::size_t>(mesh.faces.cols()))};
  std::iota(state.origins.begin(), state.origins.end(), 0);
  for (int pass = 0; pass < max_passes && halve_long_edges(state, max_length);) ++pass;
  RefinedMesh result{std::move(state.mesh), {}, std::move(state.origins)};
  result.parents.resize(2, static_cast<Eigen::Index>(state.parents.size()));
  for (std::size_t i = 0; i < state.parents.size(); ++i)
    result.parents.col(static_cast<Eigen::Index>(i)) = state.parents[i];
  return result;
}

}  // namespace bespoke
