#pragma once

#include <array>
#include <string>
#include <vector>

#include "bespoke/enum_names.h"
#include "bespoke/pattern/flat_pattern.h"

namespace bespoke {

/// What a line of a piece is, with its number in ASTM D6673 (AAMA).
enum class PatternLayer {
  boundary = 1,
  notches = 4,
  grain = 7,
  internal = 8,
  sew_line = 14,
  annotation = 15
};

inline constexpr std::array pattern_layers{Named<PatternLayer>{"boundary", PatternLayer::boundary},
                                           Named<PatternLayer>{"notches", PatternLayer::notches},
                                           Named<PatternLayer>{"grain", PatternLayer::grain},
                                           Named<PatternLayer>{"internal", PatternLayer::internal},
                                           Named<PatternLayer>{"sew", PatternLayer::sew_line},
                                           Named<PatternLayer>{"annotation", PatternLayer::annotation}};

enum class AllowanceCorners { mitred, squared };

inline constexpr std::array allowance_corners{Named<AllowanceCorners>{"mitred", AllowanceCorners::mitred},
                                              Named<AllowanceCorners>{"squared", AllowanceCorners::squared}};

struct SheetOptions {
  double seam_allowance = 0;  ///< millimetres
  AllowanceCorners corners = AllowanceCorners::mitred;
  double width = 1500;    ///< of the cloth or the roll, millimetres; a wider piece widens it
  std::string size = {};  ///< for labels; or empty
  int quantity = 1;
};

struct SheetLine {
  PatternLayer layer = PatternLayer::boundary;
  std::vector<Eigen::Vector2d> points;  ///< millimetres, y up
  bool is_closed = false;
};

struct SheetText {
  Eigen::Vector2d at;  ///< its middle
  double height = 0;   ///< of capitals, millimetres
  std::string text;
};

struct SheetNotch {
  Eigen::Vector2d at;      ///< on the boundary
  Eigen::Vector2d inward;  ///< unit vector
};

/// Of a face, for the colours of strain.
struct SheetFace {
  std::array<Eigen::Vector2d, 3> corners;
  double strain = 0;
};

/// A piece as it is drawn, at its place on the sheet.
struct SheetPiece {
  std::string name;
  std::string size;
  int quantity = 1;
  std::vector<SheetLine> lines;
  std::vector<SheetText> texts;
  std::vector<SheetNotch> notches;
  std::vector<SheetFace> faces;
  Eigen::Matrix2Xd outline;  ///< the sew line
  Eigen::AlignedBox2d box;
};

struct Sheet {
  double width = 0, height = 0;  ///< millimetres, from the origin
  std::vector<SheetPiece> pieces;
  SheetLine test_square;  ///< 50 mm, beside the pieces
  SheetText test_text;
};

/// Draws the pieces and lays them out in rows: boundary (cut line), sew line, notches at the
/// marks and at equal shares of the length of both sides of seams, grain, lines with names, the fold of a
/// symmetric piece, labels with the numbers of the seams.
Sheet pattern_sheet(const FlatPattern& pattern, const SheetOptions& options = {});

/// A garment's pattern in one size.
struct SizedPattern {
  std::string size;
  FlatPattern pattern;
};

/// Sizes of one garment nested: a piece's sizes lie over one another, grains parallel, centres of area
/// together. Throws InvalidInput unless all have the same pieces.
Sheet nested_sheet(const std::vector<SizedPattern>& sizes, const SheetOptions& options = {});

}  // namespace bespoke
