#include "bespoke/anchors/patch_borders.h"

#include <algorithm>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "bespoke/anchors/detail/enclosed_faces.h"
#include "bespoke/anchors/patch_faces.h"
#include "bespoke/error.h"
#include "bespoke/mesh/mesh_edges.h"
#include "bespoke/rigid/rigid_alignment.h"

namespace bespoke {
namespace {

/// The directed edges of inside faces that others continue: where each begins, and where it leads.
std::multimap<int, int> border_edges(const WeldedMesh& surface, const std::vector<int>& faces) {
  const MeshEdges edges = mesh_edges(surface.mesh);
  std::vector<int> inside(edges.edges.size(), 0);
  std::vector<Eigen::Index> own;
  for (std::size_t face = 0; face < surface.numbers.size(); ++face)
    if (std::binary_search(faces.begin(), faces.end(), surface.numbers[face])) {
      own.push_back(static_cast<Eigen::Index>(face));
      for (int k = 0; k < 3; ++k) ++inside[static_cast<std::size_t>(edges.of_face(k, own.back()))];
    }
  std::multimap<int, int> next;
  for (const Eigen::Index face : own)
    for (int k = 0; k < 3; ++k) {
      const auto edge = static_cast<std::size_t>(edges.of_face(k, face));
      if (inside[edge] == 1 && edges.edges[edge].faces() > 1)
        next.emplace(surface.mesh.faces(k, face), surface.mesh.faces((k + 1) % 3, face));
    }
  return next;
}

/// Vertices from `start` on, as long as edges lead on; takes these edges out.
std::vector<int> chain_from(int start, std::multimap<int, int>& next) {
  std::vector<int> chain{start};
  for (auto edge = next.find(start); edge != next.end(); edge = next.find(chain.back())) {
    chain.push_back(edge->second);
    next.erase(edge);
    if (chain.back() == start) break;
  }
  return chain;
}

FaceBorder line_through(const Points& vertices, const std::vector<int>& chain) {
  FaceBorder border{Points(3, static_cast<Eigen::Index>(chain.size()) - 1), chain.front() == chain.back()};
  for (std::size_t i = 0; i + 1 < chain.size(); ++i)
    border.line.col(static_cast<Eigen::Index>(i)) = (vertices.col(chain[i]) + vertices.col(chain[i + 1])) / 2;
  if (border.closed) return border;
  Points line(3, border.line.cols() + 2);
  line << vertices.col(chain.front()), border.line, vertices.col(chain.back());
  border.line = std::move(line);
  return border;
}

std::vector<FaceBorder> borders_of_part(const TriangleMesh& mesh, const PatchSide& part) {
  if (part.faces.empty()) return {{part.border, true}};
  return borders_of_faces(mesh, part.faces);
}

void require_as_many(const std::vector<FaceBorder>& a, const std::vector<FaceBorder>& b,
                     const std::string& where) {
  for (const bool closed : {true, false}) {
    const auto count = [&](const std::vector<FaceBorder>& borders) {
      return std::count_if(borders.begin(), borders.end(),
                           [&](const FaceBorder& border) { return border.closed == closed; });
    };
    if (count(a) != count(b))
      throw InvalidInput(
          where + " has " + std::to_string(count(a)) + (closed ? " closed" : " open") + " borders, but " +
          std::to_string(count(b)) +
          " on the target; border goes onto border, so fill holes between its faces, or divide "
          "it into patches of one piece each");
  }
}

/// Takes the one out of `borders` that lies nearest to where `border` is moved.
FaceBorder take_counterpart(const FaceBorder& border, const RigidTransform& target_from_source,
                            std::vector<FaceBorder>& borders) {
  const Vector3 middle = target_from_source * Vector3(border.line.rowwise().mean());
  double least = std::numeric_limits<double>::infinity();
  std::size_t best = 0;
  for (std::size_t k = 0; k < borders.size(); ++k) {
    const double distance = (borders[k].line.rowwise().mean() - middle).norm();
    if (borders[k].closed == border.closed && distance < least) {
      least = distance;
      best = k;
    }
  }
  FaceBorder found = std::move(borders[best]);
  borders.erase(borders.begin() + static_cast<std::ptrdiff_t>(best));
  return found;
}

}  // namespace

std::vector<FaceBorder> borders_of_faces(const TriangleMesh& mesh, const std::vector<int>& faces) {
  std::vector<int> sorted = faces;
  std::sort(sorted.begin(), sorted.end());
  std::multimap<int, int> next = border_edges(welded(mesh), sorted);
  // Open lines begin where no edge leads to; once these are taken, what is left goes round.
  std::map<int, int> surplus;
  for (const auto& [from, to] : next) {
    ++surplus[from];
    --surplus[to];
  }
  std::vector<FaceBorder> borders;
  for (const auto& [vertex, count] : surplus)
    for (int k = 0; k < count; ++k) borders.push_back(line_through(mesh.vertices, chain_from(vertex, next)));
  while (!next.empty()) borders.push_back(line_through(mesh.vertices, chain_from(next.begin()->first, next)));
  return borders;
}

std::vector<PatchBorder> patch_borders(const Anchors& anchors, const TriangleMesh& source,
                                       const TriangleMesh& target) {
  std::vector<PatchBorder> all;
  for (std::size_t k = 0; k < anchors.patches.size(); ++k) {
    const AnchorPatch& patch = anchors.patches[k];
    if (patch.exclude) continue;
    const std::vector<FaceBorder> a = borders_of_part(source, patch.a);
    std::vector<FaceBorder> b = borders_of_part(target, patch.b);
    require_as_many(a, b, label(anchors.patches, k, ModelSide::source));
    RigidTransform target_from_source;
    if (a.size() > 1)
      target_from_source =
          align_rigidly(source_points(anchors), target_points(anchors), spline_weights(anchors));
    for (const FaceBorder& border : a) {
      FaceBorder counterpart = take_counterpart(border, target_from_source, b);
      all.push_back({k, {patch.name, border.line, std::move(counterpart.line), border.closed, {}}});
    }
  }
  return all;
}

}  // namespace bespoke
