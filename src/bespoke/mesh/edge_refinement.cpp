#include "bespoke/mesh/edge_refinement.h"

#include <array>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "bespoke/error.h"

namespace bespoke {
namespace {

std::uint64_t key_of(int a, int b) {
  const auto low = static_cast<std::uint64_t>(std::min(a, b));
  const auto high = static_cast<std::uint64_t>(std::max(a, b));
  return high << 32 | low;
}

struct Refinement {
  std::vector<Vector3> vertices;
  std::vector<Eigen::Vector3i> faces;
  std::vector<Eigen::Vector2i> parents;
};

/// Midpoints of the long edges of this round; false when there are none.
bool halve_long_edges(Refinement& state, double max_length) {
  std::unordered_map<std::uint64_t, int> midpoint;
  for (const Eigen::Vector3i& face : state.faces)
    for (int k = 0; k < 3; ++k) {
      const int a = face[k], b = face[(k + 1) % 3];
      if (!((state.vertices[a] - state.vertices[b]).norm() > max_length)) continue;
      const auto [entry, is_new] =
          midpoint.try_emplace(key_of(a, b), static_cast<int>(state.vertices.size()));
      if (!is_new) continue;
      state.vertices.push_back((state.vertices[a] + state.vertices[b]) / 2);
      state.parents.emplace_back(a, b);
    }
  if (midpoint.empty()) return false;

  std::vector<Eigen::Vector3i> faces;
  faces.reserve(state.faces.size() * 2);
  for (const Eigen::Vector3i& face : state.faces) {
    std::array<int, 3> middle;
    int halved = 0;
    for (int k = 0; k < 3; ++k) {
      const auto found = midpoint.find(key_of(face[k], face[(k + 1) % 3]));
      middle[k] = found == midpoint.end() ? -1 : found->second;
      halved += middle[k] >= 0 ? 1 : 0;
    }
    // The first edge of the pattern: the halved one of one, or the one after the whole edge of two.
    int first = 0;
    while (halved == 1 && middle[first] < 0) ++first;
    while (halved == 2 && middle[(first + 2) % 3] >= 0) ++first;
    const int a = face[first], b = face[(first + 1) % 3], c = face[(first + 2) % 3];
    const int ab = middle[first], bc = middle[(first + 1) % 3], ca = middle[(first + 2) % 3];
    if (halved == 0) {
      faces.push_back(face);
    } else if (halved == 1) {
      faces.insert(faces.end(), {{a, ab, c}, {ab, b, c}});
    } else if (halved == 2) {
      faces.insert(faces.end(), {{ab, b, bc}, {a, ab, bc}, {a, bc, c}});
    } else {
      faces.insert(faces.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
  }
  state.faces = std::move(faces);
  return true;
}

}  // namespace

RefinedMesh refine_long_edges(const TriangleMesh& mesh, double max_length, int max_passes) {
  if (!(max_length > 0))
    throw InvalidInput("edges cannot be refined to a length of " + std::to_string(max_length) +
                       "; it must be positive");
  Refinement state;
  for (const auto& vertex : mesh.vertices.colwise()) state.vertices.emplace_back(vertex);
  for (const auto& face : mesh.faces.colwise()) state.faces.emplace_back(face);
  for (int pass = 0; pass < max_passes && halve_long_edges(state, max_length);) ++pass;

  RefinedMesh result;
  result.mesh.vertices.resize(3, static_cast<Eigen::Index>(state.vertices.size()));
  for (std::size_t i = 0; i < state.vertices.size(); ++i)
    result.mesh.vertices.col(static_cast<Eigen::Index>(i)) = state.vertices[i];
  result.mesh.faces.resize(3, static_cast<Eigen::Index>(state.faces.size()));
  for (std::size_t i = 0; i < state.faces.size(); ++i)
    result.mesh.faces.col(static_cast<Eigen::Index>(i)) = state.faces[i];
  result.parents.resize(2, static_cast<Eigen::Index>(state.parents.size()));
  for (std::size_t i = 0; i < state.parents.size(); ++i)
    result.parents.col(static_cast<Eigen::Index>(i)) = state.parents[i];
  return result;
}

}  // namespace bespoke
