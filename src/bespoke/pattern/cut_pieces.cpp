#include "bespoke/pattern/cut_pieces.h"

#include <algorithm>
#include <map>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/mesh/mesh_edges.h"
#include "bespoke/number_format.h"
#include "bespoke/pattern/detail/auto_cut.h"
#include "bespoke/statistics.h"
#include "bespoke/topology/half_edge_mesh.h"
#include "bespoke/topology/mesh_components.h"
#include "bespoke/topology/seams.h"

namespace bespoke {
namespace {

constexpr int no_side = -1;

/// Edges of the joined mesh along which the garment is open or cut.
class CutEdges {
 public:
  CutEdges(const Garment& garment, const JoinedMesh& joined, const CutOptions& options)
      : garment_(garment), joined_(joined), edges_(mesh_edges(joined.mesh)), options_(options) {}

  std::vector<std::array<int, 2>> run() const {
    std::vector<std::array<int, 2>> cut;
    std::vector<int> first(edges_.edges.size(), no_side);  // 3 f + k of the side seen first
    for (int f = 0; f < static_cast<int>(joined_.mesh.faces.cols()); ++f)
      for (int k = 0; k < 3; ++k) {
        const int edge = edges_.of_face(k, f);
        int& other = first[static_cast<std::size_t>(edge)];
        if (other == no_side)
          other = 3 * f + k;
        else if (is_cut(other, 3 * f + k))
          cut.push_back({edges_.edges[static_cast<std::size_t>(edge)].a,
                         edges_.edges[static_cast<std::size_t>(edge)].b});
      }
    const auto add = [&](const std::vector<std::array<int, 2>>& of_file) {
      for (const auto& [a, b] : of_file)
        cut.push_back(
            {joined_.of_vertex[static_cast<std::size_t>(a)], joined_.of_vertex[static_cast<std::size_t>(b)]});
    };
    if (options_.seams) add(options_.seams->edges());
    add(options_.further_edges);
    return cut;
  }

 private:
  static Eigen::Index corner(int side, int step) { return 3 * (side / 3) + (side % 3 + step) % 3; }
  int vertex(int side, int step) const { return garment_.mesh.faces.reshaped()[corner(side, step)]; }

  /// Of two sides that run through an edge in opposite directions.
  bool is_cut(int one, int other) const {
    if (vertex(one, 0) != vertex(other, 1) || vertex(one, 1) != vertex(other, 0)) return true;
    if (options_.seams) return false;
    const auto group = [&](int side) { return garment_.group_of_face[static_cast<std::size_t>(side / 3)]; };
    if (garment_.rule == PieceRule::charts)
      return garment_.texture.col(corner(one, 0)) != garment_.texture.col(corner(other, 1)) ||
             garment_.texture.col(corner(one, 1)) != garment_.texture.col(corner(other, 0));
    return garment_.rule != PieceRule::components && group(one) != group(other);
  }

  const Garment& garment_;
  const JoinedMesh& joined_;
  MeshEdges edges_;
  const CutOptions& options_;
};

std::string centimetres(double millimetres) { return format_number(millimetres / 10, 4) + " cm"; }

/// Empty for a disk; else what it is, with its loops.
std::string not_a_disk(const Piece& piece, const HalfEdgeMesh& mesh) {
  const std::vector<std::vector<int>> loops = boundary_loops(mesh);
  const int euler = static_cast<int>(mesh.n_vertices()) - static_cast<int>(mesh.n_edges()) +
                    static_cast<int>(mesh.n_faces());
  const int handles = (2 - euler - static_cast<int>(loops.size())) / 2;
  if (loops.size() == 1 && handles == 0) return "";
  std::string text = "piece '" + piece.name + "' is no disk: ";
  if (loops.empty())
    text += "it is closed";
  else if (loops.size() > 1)
    text += "it has " + std::to_string(loops.size()) + " boundary loops (";
  for (std::size_t k = 0; k < loops.size() && loops.size() > 1; ++k) {
    double length = 0;
    for (std::size_t i = 0; i < loops[k].size(); ++i)
      length += (piece.mesh.vertices.col(loops[k][i]) -
                 piece.mesh.vertices.col(loops[k][(i + 1) % loops[k].size()]))
                    .norm();
    constexpr std::size_t shown = 4;
    if (k == shown) text += ", …";
    if (k >= shown) continue;
    text += std::string(k > 0 ? ", " : "") + centimetres(length) + " at vertex " +
            std::to_string(piece.vertices[static_cast<std::size_t>(loops[k].front())] + 1);
  }
  if (loops.size() > 1) text += ")";
  if (handles > 0)
    text += std::string(loops.size() == 1 ? "it has " : " and ") + std::to_string(handles) +
            (handles == 1 ? " handle" : " handles");
  return text + (loops.size() > 1 ? "; cut it from one loop to another" : "; cut it open") +
         ", by a seam file (--seams) or by --auto-cut";
}

class PieceCutter {
 public:
  PieceCutter(const Garment& garment, const CutOptions& options)
      : garment_(garment), options_(options), joined_(joined_at_seams(garment.mesh)) {}

  CutPieces run() {
    if (garment_.mesh.faces.cols() == 1)
      throw InvalidInput(garment_.path + ": it is one triangle, so there is nothing to flatten");
    cut_ = CutEdges(garment_, joined_, options_).run();
    CutPieces result;
    split_into(result);
    if (options_.auto_cut && cut_to_disks(result)) split_into(result);
    for (Piece& piece : result.pieces) finish(piece);
    if (garment_.texture.cols() > 0) result.charts = chart_scale();
    return result;
  }

 private:
  void split_into(CutPieces& result) {
    const SplitMesh split = split_at_edges(joined_.mesh, cut_);
    const MeshComponents components = mesh_components(split.mesh);
    std::vector<int> number(static_cast<std::size_t>(components.count()), no_side);  // by first faces
    result.pieces.clear();
    for (const int component : components.of_face) {
      int& piece = number[static_cast<std::size_t>(component)];
      if (piece != no_side) continue;
      piece = static_cast<int>(result.pieces.size());
      result.pieces.emplace_back();
    }
    std::vector<int> local(static_cast<std::size_t>(split.mesh.vertices.cols()), no_side);
    std::vector<std::vector<int>> corners(result.pieces.size());
    for (Eigen::Index f = 0; f < split.mesh.faces.cols(); ++f) {
      const auto p = static_cast<std::size_t>(
          number[static_cast<std::size_t>(components.of_face[static_cast<std::size_t>(f)])]);
      Piece& piece = result.pieces[p];
      piece.faces.push_back(static_cast<int>(f));
      for (const int vertex : split.mesh.faces.col(f)) {
        int& own = local[static_cast<std::size_t>(vertex)];
        if (own == no_side) {
          own = static_cast<int>(piece.vertices.size());
          piece.vertices.push_back(
              joined_.first[static_cast<std::size_t>(split.origins[static_cast<std::size_t>(vertex)])]);
        }
        corners[p].push_back(own);
      }
    }
    for (std::size_t p = 0; p < result.pieces.size(); ++p) {
      Piece& piece = result.pieces[p];
      piece.mesh.faces =
          Eigen::Map<const Faces>(corners[p].data(), 3, static_cast<Eigen::Index>(corners[p].size() / 3));
      piece.mesh.vertices = garment_.mesh.vertices(Eigen::all, piece.vertices);
    }
    name(result.pieces);
  }

  void name(std::vector<Piece>& pieces) const {
    for (Piece& piece : pieces) {
      const int group = garment_.group_of_face[static_cast<std::size_t>(piece.faces.front())];
      const bool is_one = std::all_of(piece.faces.begin(), piece.faces.end(), [&](int face) {
        return garment_.group_of_face[static_cast<std::size_t>(face)] == group;
      });
      if (is_one && !garment_.group_names.empty())
        piece.name = garment_.group_names[static_cast<std::size_t>(group)];
      if (piece.name.empty()) piece.name = "piece";
    }
    if (options_.seams)
      for (const VertexName& wanted : options_.seams->names) {
        const int vertex =
            joined_
                .first[static_cast<std::size_t>(joined_.of_vertex[static_cast<std::size_t>(wanted.vertex)])];
        const auto named = std::find_if(pieces.begin(), pieces.end(), [&](const Piece& piece) {
          return std::find(piece.vertices.begin(), piece.vertices.end(), vertex) != piece.vertices.end();
        });
        if (named == pieces.end())
          throw InvalidInput(garment_.path + ": piece '" + wanted.name + "' is named by vertex " +
                             std::to_string(wanted.vertex + 1) + ", which is in no face");
        named->name = wanted.name;
      }
    std::map<std::string, int> count, used;
    for (const Piece& piece : pieces) ++count[piece.name];
    for (Piece& piece : pieces)
      if (const std::string whole = piece.name; count[whole] > 1)
        piece.name += " " + std::to_string(++used[whole]);
  }

  /// Whether some piece needed it.
  bool cut_to_disks(CutPieces& result) {
    std::map<int, int> of_first;
    for (std::size_t v = 0; v < joined_.first.size(); ++v) of_first[joined_.first[v]] = static_cast<int>(v);
    for (const Piece& piece : result.pieces) {
      const auto edges = edges_to_a_disk(piece.mesh);
      if (edges.empty()) continue;
      result.auto_cut.push_back(piece.name);
      for (const auto& [a, b] : edges)
        cut_.push_back({of_first[piece.vertices[static_cast<std::size_t>(a)]],
                        of_first[piece.vertices[static_cast<std::size_t>(b)]]});
    }
    return !result.auto_cut.empty();
  }

  void finish(Piece& piece) const {
    const HalfEdgeMesh mesh = half_edge_mesh(piece.mesh);
    if (const std::string fault = not_a_disk(piece, mesh); !fault.empty())
      throw InvalidInput(garment_.path + ": " + fault);
    piece.outline = boundary_loops(mesh).front();
    if (garment_.texture.cols() == 0) return;
    piece.texture.resize(2, 3 * static_cast<Eigen::Index>(piece.faces.size()));
    for (std::size_t f = 0; f < piece.faces.size(); ++f)
      piece.texture.middleCols<3>(static_cast<Eigen::Index>(3 * f)) =
          garment_.texture.middleCols<3>(3 * piece.faces[f]);
  }

  std::optional<ChartScale> chart_scale() const {
    std::vector<double> scales;
    for (Eigen::Index f = 0; f < garment_.mesh.faces.cols(); ++f)
      for (int k = 0; k < 3; ++k) {
        const int next = (k + 1) % 3;
        const double in_chart = (garment_.texture.col(3 * f + next) - garment_.texture.col(3 * f + k)).norm();
        const double length = (garment_.mesh.vertices.col(garment_.mesh.faces(next, f)) -
                               garment_.mesh.vertices.col(garment_.mesh.faces(k, f)))
                                  .norm();
        if (in_chart > 0) scales.push_back(length / in_chart);
      }
    if (scales.empty()) return {};
    scales = sorted_finite(std::move(scales));
    const double median = nearest_rank(scales, 0.5);
    return ChartScale{median, nearest_rank(scales, 0.05) / median, nearest_rank(scales, 0.95) / median};
  }

  const Garment& garment_;
  const CutOptions& options_;
  JoinedMesh joined_;
  std::vector<std::array<int, 2>> cut_;  ///< vertices of the joined mesh
};

}  // namespace

CutPieces cut_pieces(const Garment& garment, const CutOptions& options) {
  return PieceCutter(garment, options).run();
}

std::vector<Piece> pieces_at(std::vector<Piece> pieces, const Points& places) {
  for (Piece& piece : pieces) piece.mesh.vertices = places(Eigen::all, piece.vertices);
  return pieces;
}

}  // namespace bespoke
