#include <nlohmann/json.hpp>

#include "bespoke/pattern/detail/sheet_formats.h"

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

OrderedJson piece_json(const PatternPiece& piece, const SheetPiece& drawn) {
  const Eigen::Vector2d shift = sheet_shift(piece, drawn);
  OrderedJson json{
      {"name", piece.piece.name},
      {"vertices", columns_json(piece.flat)},
      {"faces", columns_json(piece.piece.mesh.faces)},
      {"outline", piece.piece.outline},
      {"product_vertices", piece.piece.vertices},
      {"product_faces", piece.piece.faces},
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
    root["pieces"].push_back(piece_json(pattern.pieces[p], sheet.pieces[p]));
  root["seams"] = OrderedJson::array();
  for (const PatternSeam& seam : pattern.seams) {
    OrderedJson sides = OrderedJson::array();
    for (std::size_t side = 0; side < 2; ++side)
      sides.push_back({{"piece", seam.seam.sides[side].piece},
                       {"vertices", seam.seam.sides[side].vertices},
                       {"length", seam.lengths[side]}});
    root["seams"].push_back({{"sides", sides}, {"differs", seam.differs}});
  }
  return root.dump() + "\n";
}

}  // namespace bespoke
