#include "bespoke/pattern/flat_pattern.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/number_format.h"
#include "bespoke/pattern/detail/dart.h"
#include "bespoke/pattern/detail/seam_lines.h"
#include "bespoke/pattern/detail/seam_places.h"
#include "bespoke/pattern/flattening/paired_seams.h"
#include "bespoke/pattern/sheet/grain.h"

namespace bespoke {
namespace {

/// Pieces flattened, and measured.
struct Attempt {
  CutPieces cut;
  std::vector<Seam> seams;
  FlatPieces flat;
  std::vector<ClothStrain> strains;
  std::vector<std::optional<OutlineCrossing>> overlaps;

  bool is_relieved(std::size_t p, double limit) const {
    return !overlaps[p] && strains[p].strain_p95 <= limit;
  }
};

/// Cut where the source is, so that all sizes have the same pieces.
Attempt attempt(const Garment& garment, const Garment* source, const PatternOptions& options,
                const CutOptions& cut) {
  Attempt result;
  result.cut = cut_pieces(source ? *source : garment, cut);
  result.cut.pieces = pieces_at(std::move(result.cut.pieces), garment.mesh.vertices);
  result.seams = paired_seams(result.cut.pieces, garment.path);
  set_eases(garment, result.cut.pieces, options, result.seams);
  result.flat = flatten_pieces(result.cut.pieces, result.seams, options.flatten);
  for (std::size_t p = 0; p < result.cut.pieces.size(); ++p) {
    const Piece& piece = result.cut.pieces[p];
    result.strains.push_back(cloth_strain(piece, result.flat.places[p]));
    result.overlaps.push_back(outline_crossing(result.flat.places[p], piece.outline));
  }
  return result;
}

/// The piece that strains most of those that are not relieved.
std::optional<std::size_t> worst_piece(const Attempt& result, double limit) {
  std::optional<std::size_t> worst;
  for (std::size_t p = 0; p < result.strains.size(); ++p)
    if (!result.is_relieved(p, limit) &&
        (!worst || result.strains[p].strain_p95 > result.strains[*worst].strain_p95))
      worst = p;
  return worst;
}

/// Turned so that the grain is upright.
Eigen::Matrix2Xd upright(const Eigen::Matrix2Xd& flat, const Eigen::Vector2d& grain) {
  Eigen::Matrix2d turn;
  turn << grain.y(), -grain.x(), grain.x(), grain.y();
  return turn * flat;
}

Vector3 longest_axis(const Points& points) {
  const Box box = bounding_box(points);
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  return Vector3::Unit(axis);
}

Eigen::Vector2d own_grain(const Piece& piece, const Eigen::Matrix2Xd& flat, const Garment& garment) {
  return garment.rule == PieceRule::charts ? grain_of_charts(piece, flat)
                                           : grain_along(piece, flat, longest_axis(garment.mesh.vertices));
}

void require_same_faces(const Garment& garment, const Garment& source) {
  if (source.mesh.vertices.cols() != garment.mesh.vertices.cols() ||
      source.mesh.faces.cols() != garment.mesh.faces.cols() || source.mesh.faces != garment.mesh.faces)
    throw InvalidInput(source.path + ": its faces are not those of " + garment.path +
                       "; --source is the product before the map carried it");
}

/// Pieces that overlap themselves, which no cloth can be cut into; then the strain of the worst.
std::pair<std::size_t, double> faults(const Attempt& result) {
  std::pair<std::size_t, double> found{0, 0};
  for (std::size_t p = 0; p < result.strains.size(); ++p) {
    found.first += result.overlaps[p] ? 1 : 0;
    found.second = std::max(found.second, result.strains[p].strain_p95);
  }
  return found;
}

/// Flattened, and while pieces are not relieved and darts are left, cut by one and flattened again. A dart
/// may do harm, in a narrow piece for instance: of all attempts the best.
Attempt with_darts(const Garment& garment, const Garment* source, const PatternOptions& options, int& darts) {
  CutOptions cut = options.cut;
  Attempt result = attempt(garment, source, options, cut), best = result;
  darts = 0;
  for (int cuts = 1; cuts <= options.max_darts; ++cuts) {
    const std::optional<std::size_t> worst = worst_piece(result, options.strain_limit);
    if (!worst) break;
    const Piece& piece = result.cut.pieces[*worst];
    const std::vector<int> path = dart_path(piece, result.strains[*worst].of_face);
    if (path.empty()) break;
    for (std::size_t k = 0; k + 1 < path.size(); ++k)
      cut.further_edges.push_back({piece.vertices[static_cast<std::size_t>(path[k])],
                                   piece.vertices[static_cast<std::size_t>(path[k + 1])]});
    result = attempt(garment, source, options, cut);
    if (!(faults(result) < faults(best))) continue;
    best = result;
    darts = cuts;
  }
  return best;
}

/// The source's pieces, flattened alike.
struct FlatSource {
  const Garment& garment;
  std::vector<Piece> pieces;
  FlatPieces flat;
};

/// Sets what comes from the source, if there is one; returns the grain.
Eigen::Vector2d grain_of(const Garment& garment, const std::optional<FlatSource>& source,
                         const Eigen::Matrix2Xd& flat, std::size_t p, PatternPiece& piece) {
  if (!source) return own_grain(piece.piece, flat, garment);
  const Eigen::Matrix2Xd& before = source->flat.places[p];
  piece.source_strain = cloth_strain(source->pieces[p], before);
  return carried_grain(source->pieces[p], before, own_grain(source->pieces[p], before, source->garment),
                       flat);
}

std::optional<SuggestedDart> suggested_dart(const Piece& piece, const ClothStrain& strain) {
  const std::vector<int> path = dart_path(piece, strain.of_face);
  if (path.empty()) return {};
  return SuggestedDart{piece.vertices[static_cast<std::size_t>(path.front())],
                       piece.vertices[static_cast<std::size_t>(path.back())]};
}

PatternSeam measured_seam(Seam seam, const std::vector<PatternPiece>& pieces, double tolerance) {
  PatternSeam measured;
  for (std::size_t side = 0; side < 2; ++side)
    measured.lengths[side] =
        side_length(seam.sides[side], pieces[static_cast<std::size_t>(seam.sides[side].piece)].flat);
  measured.differs = std::abs(measured.lengths[0] - measured.lengths[1] - seam.ease) > tolerance;
  measured.seam = std::move(seam);
  return measured;
}

std::string percent(double fraction) { return format_number(100 * fraction, 3) + " %"; }

std::string seam_text(const FlatPattern& pattern, const PatternSeam& seam) {
  const auto name = [&](std::size_t side) {
    return pattern.pieces[static_cast<std::size_t>(seam.seam.sides[side].piece)].piece.name;
  };
  char text[64];
  std::snprintf(text, sizeof text, "%.1f mm and %.1f mm", seam.lengths[0], seam.lengths[1]);
  std::string whole = "'" + name(0) + "' to '" + name(1) + "': " + text;
  if (seam.seam.ease != 0) whole += ", ease " + format_number(std::abs(seam.seam.ease), 3) + " mm";
  return whole;
}

/// From 1; of a vertex that was added, which has none in the file, that of the nearest one of its face.
std::string own_vertex(const FlatPattern& pattern, int vertex) {
  if (pattern.added.empty() || vertex < pattern.own_vertices) return std::to_string(vertex + 1);
  const AddedVertex& added = pattern.added[static_cast<std::size_t>(vertex - pattern.own_vertices)];
  Eigen::Index nearest = 0;
  added.weights.maxCoeff(&nearest);
  return std::to_string(added.of[static_cast<std::size_t>(nearest)] + 1);
}

std::vector<NamedWidth> named_widths(const SeamFile& seams, const std::vector<PatternPiece>& pieces) {
  std::vector<NamedWidth> widths;
  for (const VertexName& wanted : seams.widths)
    for (std::size_t p = 0; p < pieces.size(); ++p) {
      const std::vector<int>& vertices = pieces[p].piece.vertices;
      const auto found = std::find(vertices.begin(), vertices.end(), wanted.vertex);
      if (found != vertices.end())
        widths.push_back({wanted.name, static_cast<int>(p), static_cast<int>(found - vertices.begin())});
    }
  return widths;
}

/// The same of a garment that seams cut along edges only.
FlatPattern pattern_along_edges(const Garment& garment, const Garment* source,
                                const PatternOptions& options) {
  FlatPattern pattern;
  Attempt result = with_darts(garment, source, options, pattern.darts);
  pattern.charts = result.cut.charts;
  pattern.auto_cut = result.cut.auto_cut;
  pattern.summary = result.flat.summary;
  std::optional<FlatSource> flat_source;
  if (source) {
    flat_source.emplace(FlatSource{*source, pieces_at(result.cut.pieces, source->mesh.vertices), {}});
    flat_source->flat = flatten_pieces(flat_source->pieces, result.seams, options.flatten);
  }
  for (std::size_t p = 0; p < result.cut.pieces.size(); ++p) {
    PatternPiece piece;
    piece.piece = std::move(result.cut.pieces[p]);
    piece.strain = result.strains[p];
    piece.overlap = result.overlaps[p];
    const Eigen::Matrix2Xd& flat = result.flat.places[p];
    const Eigen::Vector2d grain = grain_of(garment, flat_source, flat, p, piece);
    if (options.stretch_limits)
      piece.excess = stretch_beyond(piece.piece, flat, grain, *options.stretch_limits);
    if (!result.is_relieved(p, options.strain_limit)) piece.dart = suggested_dart(piece.piece, piece.strain);
    piece.flat = upright(flat, grain);
    pattern.pieces.push_back(std::move(piece));
  }
  for (Seam& seam : result.seams)
    pattern.seams.push_back(measured_seam(std::move(seam), pattern.pieces, options.flatten.seam_tolerance));
  if (!options.marks.empty()) {
    std::vector<Piece> pieces;
    for (const PatternPiece& piece : pattern.pieces) pieces.push_back(piece.piece);
    set_marks(source ? pieces_at(std::move(pieces), source->mesh.vertices) : pieces, options.marks,
              pattern.seams);
  }
  if (options.cut.seams) pattern.widths = named_widths(*options.cut.seams, pattern.pieces);
  return pattern;
}

}  // namespace

FlatPattern flat_pattern(const Garment& garment, const Garment* source, const PatternOptions& options) {
  if (source) require_same_faces(garment, *source);
  const auto has_line = [](const SeamCut& cut) { return !cut.line.empty(); };
  if (!options.cut.seams ||
      std::none_of(options.cut.seams->cuts.begin(), options.cut.seams->cuts.end(), has_line))
    return pattern_along_edges(garment, source, options);
  const FacesAlongLines cut = faces_along_lines(source ? *source : garment, *options.cut.seams);
  PatternOptions along_edges = options;
  along_edges.cut.seams = cut.seams;
  std::optional<Garment> cut_source;
  if (source) cut_source = cut_along(*source, cut);
  FlatPattern pattern =
      pattern_along_edges(cut_along(garment, cut), cut_source ? &*cut_source : nullptr, along_edges);
  pattern.added = cut.added;
  pattern.own_vertices = static_cast<int>(garment.mesh.vertices.cols());
  pattern.own_faces = cut.of_face;
  return pattern;
}

std::string to_string(const FlatPattern& pattern, const PatternOptions& options) {
  std::string text;
  const auto line = [&](const std::string& name, const std::string& what) {
    text += name + std::string(name.size() < 12 ? 12 - name.size() : 0, ' ') + " " + what + "\n";
  };
  line("pieces", std::to_string(pattern.pieces.size()) + ", " + std::to_string(pattern.seams.size()) +
                     " seams; " + to_string(pattern.summary));
  if (pattern.charts)
    line("charts", "1 unit of texture is " + format_number(pattern.charts->mm_per_unit, 4) + " mm, edges " +
                       format_number(pattern.charts->p5, 3) + " … " + format_number(pattern.charts->p95, 3) +
                       " times that (p5 … p95)");
  for (const std::string& name : pattern.auto_cut) line("cut", "'" + name + "' was cut to a disk");
  if (pattern.darts > 0) line("darts", std::to_string(pattern.darts));
  for (const PatternPiece& piece : pattern.pieces) {
    line(piece.piece.name, to_string(piece.strain));
    if (piece.source_strain) line("  source", to_string(*piece.source_strain));
    if (piece.strain.strain_p95 > options.strain_limit)
      line("  strain",
           "p95 " + percent(piece.strain.strain_p95) + ", more than " + percent(options.strain_limit));
    if (piece.excess && piece.excess->area_share > 0)
      line("  stretch", percent(piece.excess->area_share) + " of the area beyond the limit, warp to " +
                            percent(piece.excess->warp_max) + ", weft to " + percent(piece.excess->weft_max));
    if (piece.overlap) line("  overlap", "the flat piece overlaps itself");
    if (piece.dart)
      line("  dart", "suggested: {\"path\": [" + own_vertex(pattern, piece.dart->from) + ", " +
                         own_vertex(pattern, piece.dart->to) + "]}, or --darts");
  }
  for (const PatternSeam& seam : pattern.seams)
    if (seam.differs || seam.seam.ease != 0) line("seam", seam_text(pattern, seam));
  return text;
}

}  // namespace bespoke
