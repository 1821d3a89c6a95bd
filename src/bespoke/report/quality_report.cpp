#include "bespoke/report/quality_report.h"

#include <cassert>

#include "bespoke/number_format.h"
#include "bespoke/pipeline/summary_json.h"

namespace bespoke {
namespace {

Json to_json(const Spread& spread) {
  return {{"count", spread.count},   {"min", spread.min}, {"p1", spread.p1},
          {"median", spread.median}, {"p99", spread.p99}, {"max", spread.max}};
}

Json to_json(const Penetration& penetration) {
  return {{"vertices", penetration.vertices},
          {"area_share", penetration.area_share},
          {"line_share", penetration.line_share},
          {"deepest", penetration.deepest}};
}

Json to_json(const ProductQuality& product) {
  return {{"vertices", product.vertices},
          {"faces", product.faces},
          {"lines", product.lines},
          {"line_length_ratio", to_json(product.line_lengths)},
          {"edge_length_ratio", to_json(product.distortion.edge_length)},
          {"angle_change_degrees", bespoke::to_json(product.distortion.angle)},
          {"left_out_edges", product.distortion.left_out_edges},
          {"left_out_faces", product.distortion.left_out_faces},
          {"clearance_before", to_json(product.clearance_before)},
          {"clearance_after", to_json(product.clearance_after)},
          {"clearance_change", bespoke::to_json(product.clearance_change)},
          {"unsided_vertices", product.unsided_vertices},
          {"penetration_before", to_json(product.penetration_before)},
          {"penetration_after", to_json(product.penetration_after)},
          {"newly_inside",
           {{"share", product.new_penetration.share}, {"deepest", product.new_penetration.deepest}}},
          {"self_intersections_before", product.self_intersections_before},
          {"self_intersections_after", product.self_intersections_after}};
}

std::string figure(double value) { return format_number(value, 4); }

std::string penetration_text(const Penetration& penetration, const ProductQuality& product) {
  std::string text = std::to_string(penetration.vertices) + " vertices, ";
  if (product.faces > 0) text += figure(100 * penetration.area_share) + " % of the area, ";
  if (product.lines > 0) text += figure(100 * penetration.line_share) + " % of the lines, ";
  return text + "deepest " + figure(penetration.deepest);
}

/// What an engineer needs first: how near the surfaces are, and whether anything folds.
std::string headlines(const MappingQuality& quality, const std::string& unit) {
  const Statistics& near = quality.surfaces.a_to_b;
  std::string text = "half of the mapped source lies within " + figure(near.median) + " " + unit +
                     " of the target, 95 % within " + figure(near.p95) + ", all within " + figure(near.max) +
                     "\n";
  const std::size_t folds = quality.distortion.flips, faces = quality.flipped_faces;
  if (folds == 0 && faces == 0)
    return text + "no face is flipped, and none of " + std::to_string(quality.distortion.samples) +
           " sampled points is in a fold\n";
  return text + "FOLDS: " + std::to_string(faces) + " faces are flipped, and " + std::to_string(folds) +
         " of " + std::to_string(quality.distortion.samples) +
         " sampled points are in a fold; `bespoke check` lists the places\n";
}

std::string product_text(const std::string& name, const ProductQuality& product) {
  const Statistics& change = product.clearance_change;
  std::string text = name + ": " + std::to_string(product.vertices) + " vertices, " +
                     std::to_string(product.faces) + " triangles";
  if (product.lines > 0) text += ", " + std::to_string(product.lines) + " line edges";
  text += "\n";
  if (product.faces > 0) {
    text += "  edge lengths after/before: " + to_string(product.distortion.edge_length) + "\n";
    text += "  angles change by degrees:  " + to_string(product.distortion.angle) + "\n";
  }
  if (product.lines > 0) text += "  line lengths after/before: " + to_string(product.line_lengths) + "\n";
  text += "  clearance before:          " + to_string(product.clearance_before) + "\n";
  text += "  clearance after:           " + to_string(product.clearance_after) + "\n";
  text += "  clearance kept within " + figure(change.median) + " for 50 %, " + figure(change.p95) +
          " for 95 %, " + figure(change.p99) + " for 99 % of " + std::to_string(change.count) +
          " vertices, " + figure(change.max) + " for all";
  if (product.unsided_vertices > 0)
    text += " (" + std::to_string(product.unsided_vertices) + " lie beyond the body's boundary)";
  text += "\n  inside the body before:    " + penetration_text(product.penetration_before, product) + "\n";
  text += "  inside the body after:     " + penetration_text(product.penetration_after, product) + "\n";
  if (product.new_penetration.share > 0)
    text += "  newly inside:              " + figure(100 * product.new_penetration.share) + " %, deepest " +
            figure(product.new_penetration.deepest) + "\n";
  if (product.faces > 0)
    text += "  self-intersecting pairs of faces: " + std::to_string(product.self_intersections_before) +
            " before, " + std::to_string(product.self_intersections_after) + " after\n";
  return text;
}

}  // namespace

std::string quality_text(const MappingQuality& quality, const std::vector<std::string>& names,
                         const std::string& unit) {
  assert(names.size() == quality.products.size());
  const MapDistortion& map = quality.distortion;
  std::string text = headlines(quality, unit == "unknown" ? "mesh units" : unit);
  text += "lengths in mesh units (" + unit + ")\n";
  text += "anchor residuals:            " + to_string(quality.anchor_residuals) + "\n";
  text += "mapped source to target:     " + to_string(quality.surfaces.a_to_b) + "\n";
  text += "target to mapped source:     " + to_string(quality.surfaces.b_to_a) + "\n";
  text += "Hausdorff distance:          " + figure(quality.surfaces.hausdorff) + "\n";
  text += "conformal distortion s1/s3:  " + to_string(map.conformal) + "\n";
  text += "area distortion s1 s2:       " + to_string(map.area) + "\n";
  text += "volume change det:           " + to_string(map.volume) + "\n";
  if (map.samples == 0) text += "the map is affine: these are the values of its linear part\n";
  text += "folds: " + std::to_string(map.flips) + " of " + std::to_string(map.samples) +
          " points of the band; flipped faces: " + std::to_string(quality.flipped_faces) + " of " +
          std::to_string(quality.source_faces) + "; least determinant " + figure(map.min_determinant) + "\n";
  for (std::size_t i = 0; i < names.size(); ++i) text += product_text(names[i], quality.products[i]);
  return text;
}

std::string quality_json(const MappingQuality& quality, const std::vector<std::string>& names,
                         const std::string& unit) {
  assert(names.size() == quality.products.size());
  const MapDistortion& map = quality.distortion;
  Json products = Json::array();
  for (std::size_t i = 0; i < names.size(); ++i) {
    Json product = {{"name", names[i]}};
    product.update(to_json(quality.products[i]));
    if (const NewPenetration& found = quality.products[i].new_penetration; found.is_notable())
      product["warnings"] = {to_string(found)};
    products.push_back(std::move(product));
  }
  const Json json = {{"unit", unit},
                     {"anchor_residuals", bespoke::to_json(quality.anchor_residuals)},
                     {"source_to_target", bespoke::to_json(quality.surfaces.a_to_b)},
                     {"target_to_source", bespoke::to_json(quality.surfaces.b_to_a)},
                     {"hausdorff", quality.surfaces.hausdorff},
                     {"distortion",
                      {{"samples", map.samples},
                       {"conformal", to_json(map.conformal)},
                       {"area", to_json(map.area)},
                       {"volume", to_json(map.volume)},
                       {"min_determinant", map.min_determinant},
                       {"flips", map.flips}}},
                     {"source_faces", quality.source_faces},
                     {"flipped_faces", quality.flipped_faces},
                     {"products", std::move(products)}};
  return json.dump(2) + "\n";
}

}  // namespace bespoke
