#include "bespoke/pattern/size_table.h"

#include <functional>

#include "bespoke/number_format.h"
#include "bespoke/pattern/sheet/piece_marks.h"

namespace bespoke {
namespace {

/// A name in quotes if it needs them.
std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

double flat_area(const PatternPiece& piece) {
  constexpr double square_cm_per_square_mm = 0.01;
  double twice = 0;
  for (const auto& face : piece.piece.mesh.faces.colwise()) {
    const Eigen::Vector2d a = piece.flat.col(face[1]) - piece.flat.col(face[0]);
    const Eigen::Vector2d b = piece.flat.col(face[2]) - piece.flat.col(face[0]);
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return square_cm_per_square_mm * twice / 2;
}

double extent(const PatternPiece& piece, Eigen::Index axis) {
  return piece.flat.row(axis).maxCoeff() - piece.flat.row(axis).minCoeff();
}

double width_of(const FlatPattern& pattern, const NamedWidth& width) {
  const PatternPiece& piece = pattern.pieces[static_cast<std::size_t>(width.piece)];
  const auto [left, right] = width_at(outline_places(piece), piece.flat.col(width.vertex));
  return right.x() - left.x();
}

}  // namespace

std::string size_table_csv(const std::vector<SizedPattern>& sizes) {
  std::string text = "piece,measure,unit";
  for (const SizedPattern& size : sizes) text += "," + cell(size.size);
  text += "\n";
  const auto row = [&](const std::string& name, const std::string& measure, const std::string& unit,
                       const std::function<double(const FlatPattern&)>& value) {
    text += cell(name) + "," + measure + "," + unit;
    for (const SizedPattern& size : sizes) text += "," + format_number(value(size.pattern), 6);
    text += "\n";
  };
  const FlatPattern& first = sizes.front().pattern;
  for (std::size_t p = 0; p < first.pieces.size(); ++p) {
    const std::string& name = first.pieces[p].piece.name;
    row(name, "area", "cm2", [&](const FlatPattern& of) { return flat_area(of.pieces[p]); });
    row(name, "width", "mm", [&](const FlatPattern& of) { return extent(of.pieces[p], 0); });
    row(name, "height", "mm", [&](const FlatPattern& of) { return extent(of.pieces[p], 1); });
    row(name, "strain p95", "%", [&](const FlatPattern& of) { return 100 * of.pieces[p].strain.strain_p95; });
    for (std::size_t w = 0; w < first.widths.size(); ++w)
      if (first.widths[w].piece == static_cast<int>(p))
        row(name, cell("width at " + first.widths[w].name), "mm",
            [&](const FlatPattern& of) { return width_of(of, of.widths[w]); });
  }
  for (std::size_t s = 0; s < first.seams.size(); ++s)
    for (std::size_t side = 0; side < 2; ++side) {
      const auto piece = static_cast<std::size_t>(first.seams[s].seam.sides[side].piece);
      row(first.pieces[piece].piece.name, "seam " + std::to_string(s + 1), "mm",
          [&](const FlatPattern& of) { return of.seams[s].lengths[side]; });
    }
  return text;
}

}  // namespace bespoke
