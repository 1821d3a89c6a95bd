#include <nlohmann/json.hpp>

#include "bespoke/pattern/sheet/piece_marks.h"
#include "bespoke/pattern/sheet/sheet_formats.h"

namespace bespoke {
namespace {

using OrderedJson = nlohmann::ordered_json;

OrderedJson strain_json(const ClothStrain& strain) {
  return {{"stretch_min", strain.min},       {"stretch_p5", strain.p5},
          {"stretch_p95", strain.p95},       {"stretch_max", strain.max},
          {"strain_p95", strain.strain_p95}, {"area_change", strain.area_change}};
}

template <class Columns>
OrderedJson columns_json(const Columns& columns) {
  OrderedJson list = OrderedJson::array();
  for (const auto& column : columns.colwise()) list.push_back(std::vector(column.begin(), column.end()));
  return list;
}

/// own_faces: FlatPattern::own_faces.
OrderedJson piece_json(const PatternPiece& piece, const SheetPiece& drawn,
                       const std::vector<int>& own_faces) {
  const Eigen::Vector2d shift = sheet_shift(piece, drawn);
  std::vector<int> product_faces = piece.piece.faces;
  if (!own_faces.empty())
    for (int& face : product_faces) face = own_faces[static_cast<std::size_t>(face)];
  OrderedJson json{
      {"name", piece.piece.name},
      {"vertices", columns_json(piece.flat)},
      {"faces", columns_json(piece.piece.mesh.faces)},
      {"outline", piece.piece.outline},
      {"product_vertices", piece.piece.vertices},
      {"product_faces", product_faces},
      {"on_sheet", {shift.x(), shift.y()}},
      {"strain", strain_json(piece.strain)},
      {"strain_of_faces", std::vector(piece.strain.of_face.begin(), piece.strain.of_face.end())}};
  if (piece.source_strain) json["source_strain"] = strain_json(*piece.source_strain);
  if (piece.excess)
    json["beyond_stretch_limit"] = {{"area_share", piece.excess->area_share},
                                    {"warp_max", piece.excess->warp_max},
                                    {"weft_max", piece.excess->weft_max}};
  json["overlaps_itself"] = piece.overlap.has_value();
  if (piece.dart) json["suggested_dart"] = {piece.dart->from, piece.dart->to};
  return json;
}

}  // namespace

std::string pattern_json(const FlatPattern& pattern, const Sheet& sheet, const PatternFileOptions& options) {
  OrderedJson root{
      {"name", options.name}, {"unit", "mm"}, {"grain", {0, 1}}, {"pieces", OrderedJson::array()}};
  for (std::size_t p = 0; p < pattern.pieces.size(); ++p)
    root["pieces"].push_back(piece_json(pattern.pieces[p], sheet.pieces[p], pattern.own_faces));
  root["seams"] = OrderedJson::array();
  for (const PatternSeam& seam : pattern.seams) {
    OrderedJson sides = OrderedJson::array();
    for (std::size_t side = 0; side < 2; ++side)
      sides.push_back({{"piece", seam.seam.sides[side].piece},
                       {"vertices", seam.seam.sides[side].vertices},
                       {"length", seam.lengths[side]}});
    root["seams"].push_back({{"sides", sides}, {"ease", seam.seam.ease}, {"differs", seam.differs}});
  }
  for (const NamedWidth& width : pattern.widths) {
    const PatternPiece& piece = pattern.pieces[static_cast<std::size_t>(width.piece)];
    const auto [left, right] = width_at(outline_places(piece), piece.flat.col(width.vertex));
    root["widths"].push_back({{"name", width.name}, {"piece", width.piece}, {"width", right.x() - left.x()}});
  }
  for (const AddedVertex& added : pattern.added)
    root["added_vertices"].push_back(
        {{"of", added.of}, {"weights", {added.weights[0], added.weights[1], added.weights[2]}}});
  return root.dump() + "\n";
}

}  // namespace bespoke
