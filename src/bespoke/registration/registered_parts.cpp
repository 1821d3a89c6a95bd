#include "bespoke/registration/registered_parts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "bespoke/mesh/closest_point.h"
#include "bespoke/topology/seams.h"

namespace bespoke {
namespace {

// Of a model's diagonal. An anchor as near as that lies on the surface, not on a joint within.
constexpr double on_surface = 0.005;
// Of the target's diagonal. What is nearer to the registered parts is covered by them: a fit that missed its
// target by as much would be warned of.
constexpr double covered = 0.02;

/// Components of the mesh with its seams joined, by the vertices of the mesh itself.
MeshComponents components_across_seams(const TriangleMesh& mesh) {
  const JoinedMesh joined = joined_at_seams(mesh);
  MeshComponents components = mesh_components(joined.mesh);
  const std::vector<int> of_joined = std::move(components.of_vertex);
  components.of_vertex.clear();
  std::fill(components.vertices.begin(), components.vertices.end(), 0);
  for (const int vertex : joined.of_vertex) {
    const int component = of_joined[static_cast<std::size_t>(vertex)];
    components.of_vertex.push_back(component);
    if (component != MeshComponents::none) ++components.vertices[static_cast<std::size_t>(component)];
  }
  return components;
}

/// Points on both models that belong to each other.
struct PlacePairs {
  std::vector<Vector3> a, b;
};

PlacePairs place_pairs(const Anchors& anchors) {
  PlacePairs pairs;
  for (const AnchorPair& pair : anchors.pairs) {
    pairs.a.push_back(pair.a);
    pairs.b.push_back(pair.b);
  }
  for (const AnchorCurve& curve : anchors.curves)
    for (Eigen::Index i = 0; i < std::min(curve.a.cols(), curve.b.cols()); ++i) {
      pairs.a.emplace_back(curve.a.col(i));
      pairs.b.emplace_back(curve.b.col(i));
    }
  return pairs;
}

/// For each component how many anchors lie on it and on the target.
std::vector<int> count_anchors(const TriangleMesh& source, const MeshComponents& components,
                               const TriangleMesh& target, const PlacePairs& pairs) {
  std::vector<int> counts(static_cast<std::size_t>(components.count()));
  const ClosestPointTree on_source(source), on_target(target);
  const double near_source = on_surface * diagonal(source.vertices),
               near_target = on_surface * diagonal(target.vertices);
  for (std::size_t i = 0; i < pairs.a.size(); ++i) {
    const auto at = on_source.closest(pairs.a[i], {.max_distance = near_source});
    if (at && on_target.closest(pairs.b[i], {.max_distance = near_target}))
      ++counts[static_cast<std::size_t>(components.of_face[static_cast<std::size_t>(at->face)])];
  }
  return counts;
}

double diagonal_of(const TriangleMesh& source, const MeshComponents& components, int component) {
  Box box;
  for (std::size_t vertex = 0; vertex < components.of_vertex.size(); ++vertex)
    if (components.of_vertex[vertex] == component)
      box.extend(source.vertices.col(static_cast<Eigen::Index>(vertex)));
  return box.diagonal().norm();
}

/// Where points near `before` come to lie when its vertices go to `after`: along with the nearest place.
Points carried_along(const Points& x, const TriangleMesh& before, const Points& after) {
  const ClosestPointTree tree(before);
  Points places = x;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const SurfacePoint at = *tree.closest(x.col(i));
    places.col(i) += carried(at, before.faces, after) - at.point;
  }
  return places;
}

}  // namespace

bool RegisteredParts::is_whole() const {
  return std::all_of(is_kept.begin(), is_kept.end(), [](char kept) { return kept != 0; });
}

RegisteredParts parts_to_register(const TriangleMesh& source, const TriangleMesh& target,
                                  const Anchors& anchors) {
  constexpr double about_as_large = 0.8;  // of the source's diagonal
  constexpr int min_anchors = 3;          // as many as determine where a part lies
  RegisteredParts parts{components_across_seams(source), {}};
  const MeshComponents& components = parts.components;
  parts.is_kept.assign(static_cast<std::size_t>(components.count()), 1);
  if (components.count() <= components_across_seams(target).count()) return parts;

  const std::vector<int> anchored = count_anchors(source, components, target, place_pairs(anchors));
  const bool by_anchors = *std::max_element(anchored.begin(), anchored.end()) >= min_anchors;
  const auto rank = [&](int component) {
    const auto at = static_cast<std::size_t>(component);
    return std::pair(by_anchors ? anchored[at] : 0, components.faces[at]);
  };
  int main = 0;
  for (int k = 1; k < components.count(); ++k)
    if (rank(k) > rank(main)) main = k;
  if (!by_anchors && diagonal_of(source, components, main) < about_as_large * diagonal(source.vertices))
    return parts;
  for (int k = 0; k < components.count(); ++k)
    parts.is_kept[static_cast<std::size_t>(k)] = k == main || anchored[static_cast<std::size_t>(k)] > 0;
  return parts;
}

bool keep_uncovered(RegisteredParts& parts, const TriangleMesh& source, const TriangleMesh& target,
                    const Points& registered) {
  constexpr Eigen::Index max_samples = 20000;
  constexpr double clearly_nearer = 0.5;  // of the registered parts' distance
  constexpr double enough = 0.25;         // of the component's area as it lies on the target
  if (parts.is_whole()) return false;
  std::vector<char> is_loose;
  for (const char kept : parts.is_kept) is_loose.push_back(!kept);
  const PartialMesh kept = parts.mesh(source);
  PartialMesh loose = kept_components(source, parts.components, is_loose);
  loose.mesh.vertices = carried_along(loose.mesh.vertices, kept.mesh, registered);
  const ClosestPointTree on_kept({registered, kept.mesh.faces}), on_loose(loose.mesh);
  const double reach = covered * diagonal(target.vertices);

  std::vector<double> nearest_area(parts.is_kept.size(), 0), own(parts.is_kept.size(), 0);
  const auto component_of = [&](int face) {
    const int vertex = loose.vertices[static_cast<std::size_t>(loose.mesh.faces(0, face))];
    return static_cast<std::size_t>(parts.components.of_vertex[static_cast<std::size_t>(vertex)]);
  };
  // Every vertex of the target stands for its area, of a large one every so manieth for as many.
  const Eigen::VectorXd target_areas = vertex_areas(target);
  const Eigen::Index stride = std::max<Eigen::Index>(1, target_areas.size() / max_samples);
  for (Eigen::Index i = 0; i < target_areas.size(); i += stride) {
    if (!(target_areas[i] > 0)) continue;
    const Vector3 x = target.vertices.col(i);
    const double distance = std::sqrt(on_kept.closest(x)->squared_distance);
    if (!(distance > reach)) continue;
    if (const auto at = on_loose.closest(x, {.max_distance = clearly_nearer * distance}))
      nearest_area[component_of(at->face)] += double(stride) * target_areas[i];
  }
  const Eigen::VectorXd areas = vertex_areas(loose.mesh);
  for (std::size_t i = 0; i < loose.vertices.size(); ++i)
    own[static_cast<std::size_t>(parts.components.of_vertex[static_cast<std::size_t>(loose.vertices[i])])] +=
        areas[static_cast<Eigen::Index>(i)];
  bool has_more = false;
  for (std::size_t k = 0; k < parts.is_kept.size(); ++k) {
    if (parts.is_kept[k] || !(nearest_area[k] > 0 && nearest_area[k] >= enough * own[k])) continue;
    parts.is_kept[k] = 1;
    has_more = true;
  }
  return has_more;
}

std::vector<LoosePart> loose_parts(const RegisteredParts& parts) {
  std::vector<LoosePart> loose;
  const MeshComponents& components = parts.components;
  std::vector<int> first(parts.is_kept.size(), -1);
  for (std::size_t vertex = 0; vertex < components.of_vertex.size(); ++vertex)
    if (const int k = components.of_vertex[vertex]; k != MeshComponents::none)
      if (int& least = first[static_cast<std::size_t>(k)]; least < 0) least = static_cast<int>(vertex);
  for (std::size_t k = 0; k < parts.is_kept.size(); ++k)
    if (!parts.is_kept[k])
      loose.push_back({static_cast<int>(k), first[k], components.vertices[k], components.faces[k], {}});
  return loose;
}

std::string to_string(const LoosePartsSummary& summary) {
  constexpr std::size_t max_names = 10;
  // Parts of one group together, the most vertices first.
  std::map<std::string, int> vertices;
  for (const LoosePart& part : summary.loose)
    vertices[part.name.empty() ? "part " + std::to_string(part.component + 1) : '"' + part.name + '"'] +=
        part.vertices;
  std::vector<std::pair<int, std::string>> names;
  for (const auto& [name, count] : vertices) names.emplace_back(-count, name);
  std::sort(names.begin(), names.end());
  std::string text = std::to_string(summary.loose.size()) + " of " + std::to_string(summary.parts) +
                     " parts of the source have no counterpart on the target and follow the map as products "
                     "do: ";
  for (std::size_t i = 0; i < std::min(max_names, names.size()); ++i)
    text += (i == 0 ? "" : ", ") + names[i].second + " (" + std::to_string(-names[i].first) + " vertices)";
  if (names.size() > max_names) text += " and " + std::to_string(names.size() - max_names) + " more";
  return text;
}

}  // namespace bespoke
