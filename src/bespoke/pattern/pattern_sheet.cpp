#include "bespoke/pattern/pattern_sheet.h"

#include <algorithm>
#include <numeric>

#include "bespoke/error.h"
#include "bespoke/pattern/sheet/piece_marks.h"
#include "bespoke/pattern/sheet/seam_allowance.h"

namespace bespoke {
namespace {

// Millimetres, all of them.
constexpr double gap = 20;          // between pieces, so that scissors pass
constexpr double test_square = 50;  // as printed patterns have it
constexpr double notch_length = 5;
constexpr double text_height = 6, small_text_height = 3;
constexpr double seam_number_inset = 8;

constexpr double grain_share = 0.7;  // of the cloth above and below the label

std::vector<Eigen::Vector2d> listed_points(const Eigen::Matrix2Xd& places) {
  std::vector<Eigen::Vector2d> points;
  for (const auto& x : places.colwise()) points.emplace_back(x);
  return points;
}

/// The marks of one piece that its seams give it.
struct SeamMarks {
  std::vector<OutlineMark> notches;
  std::vector<std::pair<int, OutlineMark>> numbers;  ///< of seams, from 1
  std::vector<std::pair<std::string, Eigen::Vector2d>> widths;
};

std::vector<SeamMarks> marks_of_pieces(const FlatPattern& pattern) {
  std::vector<SeamMarks> marks(pattern.pieces.size());
  for (std::size_t s = 0; s < pattern.seams.size(); ++s) {
    const PatternSeam& seam = pattern.seams[s];
    const auto notches = seam_notches(pattern, seam);
    const auto numbers = seam_marks(pattern, seam, {0.4});  // beside a notch in the middle
    for (std::size_t side = 0; side < 2; ++side) {
      SeamMarks& own = marks[static_cast<std::size_t>(seam.seam.sides[side].piece)];
      own.notches.insert(own.notches.end(), notches[side].begin(), notches[side].end());
      own.numbers.emplace_back(static_cast<int>(s) + 1, numbers[side].front());
    }
  }
  for (const NamedWidth& width : pattern.widths) {
    const auto p = static_cast<std::size_t>(width.piece);
    marks[p].widths.emplace_back(width.name, pattern.pieces[p].flat.col(width.vertex));
  }
  return marks;
}

/// The lines across the grain that have names.
void add_widths(const SeamMarks& marks, SheetPiece& drawn) {
  for (const auto& [name, at] : marks.widths) {
    const auto [left, right] = width_at(drawn.outline, at);
    drawn.lines.push_back({PatternLayer::internal, {left, right}, false});
    constexpr double share = 0.2;  // of the line, from its left end: clear of the grain and of folds
    drawn.texts.push_back(
        {left + share * (right - left) + Eigen::Vector2d(0, small_text_height), small_text_height, name});
  }
}

void add_labels(const PatternPiece& piece, const SeamMarks& marks, const SheetOptions& options,
                SheetPiece& drawn) {
  const WidePlace place = wide_place(piece);
  std::vector<std::string> rows{piece.piece.name};
  if (!options.size.empty()) rows.push_back("size " + options.size);
  rows.push_back("cut " + std::to_string(options.quantity));
  const double height = std::clamp(place.radius / 5, 1.5, text_height);
  for (std::size_t k = 0; k < rows.size(); ++k)
    drawn.texts.push_back(
        {place.at + Eigen::Vector2d(0, height * (1.6 * (1 - static_cast<double>(k)))), height, rows[k]});
  const double inset = std::min(seam_number_inset, place.radius / 3);
  for (const auto& [number, mark] : marks.numbers)
    drawn.texts.push_back(
        {mark.at + inset * mark.inward, std::min(small_text_height, inset / 2), std::to_string(number)});
  // The grain beside the label, where the piece is still nearly as wide.
  const Eigen::Vector2d beside = place.at + Eigen::Vector2d(place.radius / 2, 0);
  const auto [low, high] = upright_extent(drawn.outline, beside);
  drawn.lines.push_back({PatternLayer::grain,
                         {{beside.x(), beside.y() + grain_share * (low - beside.y())},
                          {beside.x(), beside.y() + grain_share * (high - beside.y())}},
                         false});
  if (const std::optional<double> x = fold_line(piece)) {
    const auto [bottom, top] = upright_extent(drawn.outline, {*x, centre_of_area(drawn.outline).y()});
    drawn.lines.push_back({PatternLayer::internal, {{*x, bottom}, {*x, top}}, false});
    drawn.texts.push_back(
        {{*x, bottom + 0.15 * (top - bottom)}, std::min(small_text_height, height), "fold"});
  }
}

/// As it lies in the pattern.
SheetPiece drawn_piece(const PatternPiece& piece, const SeamMarks& marks, const SheetOptions& options) {
  SheetPiece drawn;
  drawn.name = piece.piece.name;
  drawn.size = options.size;
  drawn.quantity = options.quantity;
  drawn.outline = outline_places(piece);
  const SheetLine sew{PatternLayer::sew_line, listed_points(drawn.outline), true};
  if (options.seam_allowance > 0) {
    for (auto& line : with_allowance(drawn.outline, options.seam_allowance, options.corners))
      drawn.lines.push_back({PatternLayer::boundary, std::move(line), true});
    drawn.lines.push_back(sew);
  } else {
    drawn.lines.push_back({PatternLayer::boundary, sew.points, true});
    drawn.lines.push_back(sew);
  }
  for (const OutlineMark& mark : marks.notches)
    drawn.notches.push_back({mark.at - options.seam_allowance * mark.inward, mark.inward});
  add_labels(piece, marks, options, drawn);
  add_widths(marks, drawn);
  for (Eigen::Index f = 0; f < piece.piece.mesh.faces.cols(); ++f) {
    SheetFace face;
    for (int k = 0; k < 3; ++k)
      face.corners[static_cast<std::size_t>(k)] = piece.flat.col(piece.piece.mesh.faces(k, f));
    face.strain = piece.strain.of_face[f];
    drawn.faces.push_back(face);
  }
  for (const SheetLine& line : drawn.lines)
    for (const Eigen::Vector2d& x : line.points) drawn.box.extend(x);
  return drawn;
}

void shift(SheetPiece& piece, const Eigen::Vector2d& by) {
  for (SheetLine& line : piece.lines)
    for (Eigen::Vector2d& x : line.points) x += by;
  for (SheetText& text : piece.texts) text.at += by;
  for (SheetNotch& notch : piece.notches) notch.at += by;
  for (SheetFace& face : piece.faces)
    for (Eigen::Vector2d& x : face.corners) x += by;
  piece.outline.colwise() += by;
  piece.box.translate(by);
}

/// Pieces that move together: the sizes of one.
using Stack = std::vector<SheetPiece>;

Eigen::AlignedBox2d box_of(const Stack& stack) {
  Eigen::AlignedBox2d box;
  for (const SheetPiece& piece : stack) box.extend(piece.box);
  return box;
}

/// In rows from the top, the highest first; the test square begins.
Sheet laid_out(std::vector<Stack> stacks, double width) {
  std::vector<std::size_t> order(stacks.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto height = [&](std::size_t k) { return box_of(stacks[k]).sizes().y(); };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t i, std::size_t j) { return height(i) > height(j); });
  Sheet sheet;
  sheet.width = width;
  for (const Stack& stack : stacks) sheet.width = std::max(sheet.width, box_of(stack).sizes().x() + 2 * gap);
  double x = gap + test_square + gap, y = gap, row = test_square, right = x;  // y from the top
  for (const std::size_t k : order) {
    const Eigen::AlignedBox2d box = box_of(stacks[k]);
    if (x + box.sizes().x() + gap > sheet.width) {
      y += row + gap;
      x = gap;
      row = 0;
    }
    for (SheetPiece& piece : stacks[k]) shift(piece, Eigen::Vector2d(x - box.min().x(), -y - box.max().y()));
    x += box.sizes().x() + gap;
    right = std::max(right, x);
    row = std::max(row, box.sizes().y());
  }
  sheet.width = right;
  sheet.height = y + row + gap;
  const Eigen::Vector2d up(0, sheet.height);
  for (Stack& stack : stacks)
    for (SheetPiece& piece : stack) {
      shift(piece, up);
      sheet.pieces.push_back(std::move(piece));
    }
  const Eigen::Vector2d corner(gap, sheet.height - gap - test_square);
  for (const auto& [i, j] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 1}})
    sheet.test_square.points.push_back(corner + test_square * Eigen::Vector2d(i, j));
  sheet.test_square.is_closed = true;
  sheet.test_square.layer = PatternLayer::annotation;
  sheet.test_text = {corner + test_square / 2 * Eigen::Vector2d(1, 1), small_text_height, "5 cm"};
  return sheet;
}

}  // namespace

Sheet pattern_sheet(const FlatPattern& pattern, const SheetOptions& options) {
  const std::vector<SeamMarks> marks = marks_of_pieces(pattern);
  std::vector<Stack> stacks;
  for (std::size_t p = 0; p < pattern.pieces.size(); ++p)
    stacks.push_back({drawn_piece(pattern.pieces[p], marks[p], options)});
  return laid_out(std::move(stacks), options.width);
}

Sheet nested_sheet(const std::vector<SizedPattern>& sizes, const SheetOptions& options) {
  if (sizes.empty()) throw InvalidInput("there are no sizes to nest");
  std::vector<Stack> stacks(sizes.front().pattern.pieces.size());
  for (const SizedPattern& size : sizes) {
    if (size.pattern.pieces.size() != stacks.size())
      throw InvalidInput("size '" + size.size + "' has " + std::to_string(size.pattern.pieces.size()) +
                         " pieces, but size '" + sizes.front().size + "' has " +
                         std::to_string(stacks.size()));
    SheetOptions own = options;
    own.size = size.size;
    const std::vector<SeamMarks> marks = marks_of_pieces(size.pattern);
    for (std::size_t p = 0; p < stacks.size(); ++p) {
      SheetPiece piece = drawn_piece(size.pattern.pieces[p], marks[p], own);
      shift(piece, -centre_of_area(piece.outline));
      stacks[p].push_back(std::move(piece));
    }
  }
  return laid_out(std::move(stacks), options.width);
}

}  // namespace bespoke
