#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/pattern/cloth_strain.h"
#include "bespoke/pattern/cut_pieces.h"
#include "bespoke/pattern/flatten_pieces.h"
#include "bespoke/pattern/self_overlap.h"

namespace bespoke {

/// A place of the body or the garment that gets a notch on the seam beside it: an anchor, the end of a curve.
struct SurfaceMark {
  std::string name;
  Vector3 place;  ///< millimetres, where the source is, or else the garment
};

struct PatternOptions {
  CutOptions cut = {};
  FlattenOptions flatten = {};
  int max_darts = 0;           ///< cut where a piece overlaps itself or strains cloth beyond `strain_limit`
  double strain_limit = 0.02;  ///< p95 of a piece's strain, a fraction: woven cloth eases that in
  std::optional<StretchLimits> stretch_limits = {};
  std::vector<SurfaceMark> marks = {};
  std::map<int, double> eases = {};  ///< of seams by their numbers from 1, as Seam::ease
};

/// A cut into a piece that would relieve it, by vertices of the product.
struct SuggestedDart {
  int from = 0;  ///< on the outline
  int to = 0;    ///< inside
};

struct PatternPiece {
  Piece piece;
  Eigen::Matrix2Xd flat;  ///< 2×n, millimetres, the grain upright
  ClothStrain strain;
  std::optional<ClothStrain> source_strain;  ///< of the source's own piece, flattened alike
  std::optional<StretchExcess> excess;
  std::optional<OutlineCrossing> overlap;
  std::optional<SuggestedDart> dart;  ///< of a piece that overlaps itself or strains beyond the limit
};

/// A place on both sides of a seam.
struct SeamPlace {
  int edge = 0;      ///< from its vertex number `edge` to the next
  double share = 0;  ///< of that edge
};

struct PatternSeam {
  Seam seam;
  std::array<double, 2> lengths{};  ///< of the flat sides, millimetres
  bool differs = false;             ///< from what it eases, by more than the tolerance
  std::vector<SeamPlace> marks = {};
};

/// A line across the grain through a vertex of a piece.
struct NamedWidth {
  std::string name;
  int piece = 0;
  int vertex = 0;  ///< of the piece's mesh
};

/// The flat pieces of a garment.
struct FlatPattern {
  std::vector<PatternPiece> pieces;
  std::vector<PatternSeam> seams;
  std::vector<NamedWidth> widths;
  std::vector<AddedVertex> added;  ///< vertices behind the product's own, where lines of seams cut faces
  int own_vertices = 0;            ///< the product's, where there are added ones
  std::vector<int> own_faces;  ///< the product's triangle of each face that pieces number, or none: itself
  std::optional<ChartScale> charts;
  std::vector<std::string> auto_cut;
  int darts = 0;  ///< that were cut
  FlattenSummary summary;
};

/// Cuts, flattens and measures. source: the same garment before a map carried it, millimetres: its pieces
/// give the grain and the strain beside; or none. Without it, the grain is that of the charts, or runs
/// upwards along the garment's longest side. Throws as cut_pieces and flatten_pieces, and InvalidInput for a
/// source of other faces.
FlatPattern flat_pattern(const Garment& garment, const Garment* source, const PatternOptions& options = {});

/// One line a piece and a seam that differs, and what was found besides.
std::string to_string(const FlatPattern& pattern, const PatternOptions& options);

}  // namespace bespoke
