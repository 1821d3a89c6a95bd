#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/pattern/garment.h"
#include "bespoke/pattern/piece.h"
#include "bespoke/pattern/seam_file.h"

namespace bespoke {

struct CutOptions {
  std::optional<SeamFile> seams = {};                  ///< cut there instead of where the garment's rule says
  std::vector<std::array<int, 2>> further_edges = {};  ///< besides: darts
  bool auto_cut = false;  ///< pieces that are no disks are cut along shortest loops
};

/// A texture whose charts are the pattern has one scale.
struct ChartScale {
  double mm_per_unit = 0;  ///< median over the edges
  double p5 = 0, p95 = 0;  ///< of an edge's own scale over the median
};

struct CutPieces {
  std::vector<Piece> pieces;          ///< in the order of their first faces
  std::optional<ChartScale> charts;   ///< of a garment with texture
  std::vector<std::string> auto_cut;  ///< names of pieces that were cut to disks
};

/// Edges that are open in the file stay open, and edges of three faces are opened. A piece has its group's
/// name where its faces have one, else a number; equal names get numbers. Throws InvalidInput for a product
/// of one triangle, for a name of a vertex in no piece, and for pieces that are no disks, with their boundary
/// loops.
CutPieces cut_pieces(const Garment& garment, const CutOptions& options = {});

/// The pieces with their vertices at other places: 3×n of the product they were cut from, millimetres.
std::vector<Piece> pieces_at(std::vector<Piece> pieces, const Points& places);

}  // namespace bespoke
