#include "bespoke/pattern/detail/seam_places.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/pattern/flattening/paired_seams.h"
#include "bespoke/topology/seams.h"

namespace bespoke {
namespace {

// Millimetres: a garment hangs at most a hand's breadth off the body on which anchors lie.
constexpr double mark_reach = 100;

using EdgeSet = std::set<std::pair<int, int>>;

/// As pieces number the vertices: of those at one place the first.
EdgeSet edges_of_cut(const JoinedMesh& joined, const SeamCut& cut) {
  const auto own = [&](int vertex) {
    return joined.first[static_cast<std::size_t>(joined.of_vertex[static_cast<std::size_t>(vertex)])];
  };
  EdgeSet edges;
  for (const auto& [a, b] : cut.edges) edges.insert(std::minmax({own(a), own(b)}));
  return edges;
}

bool runs_along(const Piece& piece, const SeamSide& side, const EdgeSet& edges) {
  for (std::size_t k = 0; k + 1 < side.vertices.size(); ++k) {
    const auto vertex = [&](std::size_t i) {
      return piece.vertices[static_cast<std::size_t>(side.vertices[i])];
    };
    if (!edges.contains(std::minmax({vertex(k), vertex(k + 1)}))) return false;
  }
  return true;
}

/// Parts of one cut share its ease by their lengths.
void ease_cut(const std::vector<Piece>& pieces, const SeamCut& cut, const EdgeSet& edges,
              std::vector<Seam>& seams) {
  const auto named = std::find_if(pieces.begin(), pieces.end(),
                                  [&](const Piece& piece) { return piece.name == cut.longer; });
  if (named == pieces.end())
    throw InvalidInput("a seam eases to the side of '" + cut.longer + "', but no piece is called so");
  const int longer = static_cast<int>(named - pieces.begin());
  std::vector<std::pair<Seam*, double>> parts;
  double whole = 0;
  for (Seam& seam : seams) {
    const bool is_first = seam.sides[0].piece == longer, is_second = seam.sides[1].piece == longer;
    if (is_first == is_second || !runs_along(*named, seam.sides[is_first ? 0 : 1], edges)) continue;
    const double length = side_length(seam.sides[is_first ? 0 : 1], named->mesh.vertices);
    parts.emplace_back(&seam, is_first ? length : -length);
    whole += length;
  }
  if (parts.empty())
    throw InvalidInput("a seam eases to the side of '" + cut.longer +
                       "', but joins that piece with no other one");
  for (const auto& [seam, length] : parts) seam->ease = cut.ease * length / whole;
}

struct NearSeam {
  std::size_t seam = 0;
  SeamPlace place;
  double squared_distance = mark_reach * mark_reach;
};

std::optional<NearSeam> nearest_seam(const std::vector<Piece>& pieces, const std::vector<PatternSeam>& seams,
                                     const Vector3& x) {
  std::optional<NearSeam> best;
  for (std::size_t s = 0; s < seams.size(); ++s) {
    const SeamSide& side = seams[s].seam.sides[0];
    const Points& places = pieces[static_cast<std::size_t>(side.piece)].mesh.vertices;
    for (std::size_t k = 0; k + 1 < side.vertices.size(); ++k) {
      const Vector3 a = places.col(side.vertices[k]), way = places.col(side.vertices[k + 1]) - a;
      const double share = std::clamp((x - a).dot(way) / way.squaredNorm(), 0.0, 1.0);
      const double squared = (x - a - share * way).squaredNorm();
      if (squared < (best ? best->squared_distance : mark_reach * mark_reach))
        best = NearSeam{s, {static_cast<int>(k), share}, squared};
    }
  }
  return best;
}

/// Of the squared distance to the nearest place of the garment's vertices.
double squared_distance_to(const std::vector<Piece>& pieces, const Vector3& x) {
  double least = std::numeric_limits<double>::infinity();
  for (const Piece& piece : pieces)
    least = std::min(least, (piece.mesh.vertices.colwise() - x).colwise().squaredNorm().minCoeff());
  return least;
}

}  // namespace

void set_eases(const Garment& garment, const std::vector<Piece>& pieces, const PatternOptions& options,
               std::vector<Seam>& seams) {
  if (options.cut.seams && std::any_of(options.cut.seams->cuts.begin(), options.cut.seams->cuts.end(),
                                       [](const SeamCut& cut) { return cut.ease > 0; })) {
    const JoinedMesh joined = joined_at_seams(garment.mesh);
    for (const SeamCut& cut : options.cut.seams->cuts)
      if (cut.ease > 0) ease_cut(pieces, cut, edges_of_cut(joined, cut), seams);
  }
  for (const auto& [number, ease] : options.eases) {
    if (number < 1 || number > static_cast<int>(seams.size()))
      throw InvalidInput("--ease " + std::to_string(number) + "=…: the pattern has the seams 1 … " +
                         std::to_string(seams.size()));
    seams[static_cast<std::size_t>(number) - 1].ease = ease;
  }
}

void set_marks(const std::vector<Piece>& pieces, const std::vector<SurfaceMark>& marks,
               std::vector<PatternSeam>& seams) {
  // A mark in the middle of a piece is none of a seam's: the seam must be as near as the garment, within
  // this.
  constexpr double aside = 20;  // millimetres
  for (const SurfaceMark& mark : marks) {
    const std::optional<NearSeam> near = nearest_seam(pieces, seams, mark.place);
    if (!near) continue;
    if (std::sqrt(near->squared_distance) > std::sqrt(squared_distance_to(pieces, mark.place)) + aside)
      continue;
    seams[near->seam].marks.push_back(near->place);
  }
}

}  // namespace bespoke
