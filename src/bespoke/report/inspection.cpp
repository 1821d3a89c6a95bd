#include "bespoke/report/inspection.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <vector>

#include "bespoke/number_format.h"
#include "bespoke/pipeline/summary_json.h"
#include "bespoke/report/chain_determinant.h"

namespace bespoke {
namespace {

std::string number(double value) { return format_number(value, 6); }

std::string tuple(const Vector3& v) { return format_number(v, 6); }

std::string rows(const Matrix3& matrix) {
  std::string text;
  for (int row = 0; row < 3; ++row) text += (row ? " " : "") + tuple(matrix.row(row).transpose());
  return text;
}

std::string model(const ModelRecord& record) {
  return record.hash + ", box " + tuple(record.box.min()) + " to " + tuple(record.box.max());
}

Json to_json(const PyramidLevel& level) {
  return {{"voxel_size", level.voxel_size},
          {"leaves", level.leaves.size()},
          {"voxels", level.leaves.size() * leaf_nodes}};
}

Json to_json(const ModelRecord& record) {
  return {{"hash", record.hash}, {"box", bespoke::to_json(record.box)}};
}

Json to_json(const AnchorRecord& anchor) {
  Json json = {{"name", anchor.name}, {"a", bespoke::to_json(anchor.a)}, {"b", bespoke::to_json(anchor.b)}};
  if (std::isfinite(anchor.weight)) json["weight"] = anchor.weight;
  if (anchor.sigma > 0) json["sigma"] = anchor.sigma;
  json["residual"] = anchor.residual;
  return json;
}

Json embedded(const std::string& json) { return json.empty() ? Json() : Json::parse(json); }

/// Why the map is a bijection, with the value of each condition; or which of them fails.
std::string certificate_text(const Asset& asset, const Certificate& certificate) {
  const std::size_t steps = asset.steps.size();
  std::ostringstream text;
  if (certificate.is_bijection() && steps > 1) {
    text << "proved to be a bijection of all of space (one-to-one): each of its " << steps
         << " steps is one, continuous, trilinear in every finest cell with positive det of its gradient in "
            "all "
         << certificate.certified << " of them, and affine outside; det of the whole at least "
         << number(certificate.min_determinant)
         << ", the product of the steps' bounds, and at sampled places "
         << number(sampled_min_determinant(asset)) << " or more";
  } else if (certificate.is_bijection()) {
    text << "proved to be a bijection of all of space (one-to-one): continuous, trilinear in every finest "
            "cell with det of "
            "its gradient at least "
         << number(certificate.min_determinant) << " in all " << certificate.certified
         << " of them, and affine with det " << number(certificate.affine_determinant)
         << " outside; such a map is a local homeomorphism of degree 1";
  } else {
    text << "NOT PROVED to be one-to-one: " << certificate.certified << " cells certified, "
         << certificate.undecided << " undecided, " << certificate.folded
         << " folded, det of the affine part " << number(certificate.affine_determinant);
    if (!certificate.places.empty())
      text << "; the first of these cells lies at " << tuple(certificate.places.front().center);
  }
  return text.str();
}

std::string anchor_table(const std::vector<AnchorRecord>& anchors) {
  std::ostringstream text;
  text << "anchors      " << anchors.size() << '\n';
  if (anchors.empty()) return text.str();
  std::size_t width = 4;
  for (const AnchorRecord& anchor : anchors) width = std::max(width, anchor.name.size());
  const auto row = [&](std::string name, const std::string& weight, const std::string& residual) {
    name.resize(width, ' ');
    text << "  " << name << "  " << std::setw(16) << weight << "  " << std::setw(12) << residual << '\n';
  };
  row("name", "weight", "residual");
  for (const AnchorRecord& anchor : anchors)
    row(anchor.name.empty() ? "-" : anchor.name,
        anchor.sigma > 0            ? "sigma " + number(anchor.sigma)
        : std::isinf(anchor.weight) ? "exact"
                                    : number(anchor.weight),
        number(anchor.residual));
  return text.str();
}

std::string step_text(const MapStep& step) {
  std::ostringstream text;
  text << "affine       " << rows(step.affine.linear) << ", offset " << tuple(step.affine.offset) << '\n';
  for (std::size_t k = 0; k < step.pyramid.levels.size(); ++k) {
    const PyramidLevel& level = step.pyramid.levels[k];
    text << "level " << k << "      voxel size " << number(level.voxel_size) << ", "
         << level.leaves.size() * leaf_nodes << " voxels in " << level.leaves.size() << " leaves\n";
  }
  return text.str();
}

Json levels_json(const Pyramid& pyramid) {
  Json levels = Json::array();
  for (const PyramidLevel& level : pyramid.levels) levels.push_back(to_json(level));
  return levels;
}

Json steps_json(const Asset& asset) {
  Json steps = Json::array();
  for (const MapStep& step : asset.steps)
    steps.push_back({{"affine_linear", bespoke::to_json(step.affine.linear)},
                     {"affine_offset", bespoke::to_json(step.affine.offset)},
                     {"levels", levels_json(step.pyramid)},
                     {"certificate", bespoke::to_json(step.certificate)}});
  return steps;
}

std::string bake_line(const AssetRecord& record) {
  if (record.bake_error.count == 0) return "stored       as fitted, without an error of its own";
  return "bake error   " + bespoke::to_string(record.bake_error) + ", tolerance " + number(record.tolerance) +
         (record.bake_error.max <= record.tolerance ? "" : ", MISSED");
}

}  // namespace

std::string inspection_text(const Asset& asset) {
  const AssetRecord& record = asset.record;
  std::ostringstream text;
  const Certificate certificate = whole_certificate(asset);
  const std::string proof = "certificate  " + certificate_text(asset, certificate) + "\n";
  if (!certificate.is_bijection()) text << proof;  // what matters most comes first
  text << "map          maps points a to b: of the source's space to the target's, unit " << record.unit
       << '\n'
       << bake_line(record) << '\n';
  if (certificate.is_bijection()) text << proof;
  text << "method       registration " << record.surface_fit_method << ", elastic " << record.elastic_method
       << ", effective distance " << number(record.lambda) << '\n'
       << "rotation     " << rows(asset.target_from_source.rotation) << ", path "
       << name_of(rotation_paths, asset.path) << '\n'
       << "translation  " << tuple(asset.target_from_source.translation) << '\n';
  if (asset.steps.size() > 1) text << "steps        " << asset.steps.size() << ", one after the other\n";
  for (std::size_t k = 0; k < asset.steps.size(); ++k) {
    if (asset.steps.size() > 1) text << "step " << k << '\n';
    text << step_text(asset.steps[k]);
  }
  text << "precision    " << name_of(asset.steps.front().pyramid.precision) << '\n'
       << "source       " << model(record.source) << '\n'
       << "target       " << model(record.target) << '\n'
       << "exact map    "
       << (asset.exact_map.empty() ? "not stored" : std::to_string(asset.exact_map.size()) + " bytes") << '\n'
       << anchor_table(record.anchors);
  return text.str();
}

std::string inspection_json(const Asset& asset) {
  const AssetRecord& record = asset.record;
  const MapStep& first = asset.steps.front();
  Json anchors = Json::array();
  for (const AnchorRecord& anchor : record.anchors) anchors.push_back(to_json(anchor));
  Json json = {{"direction", "maps points a to b"},
               {"unit", record.unit},
               {"rotation", bespoke::to_json(asset.target_from_source.rotation)},
               {"translation", bespoke::to_json(asset.target_from_source.translation)},
               {"path", name_of(rotation_paths, asset.path)},
               {"affine_linear", bespoke::to_json(first.affine.linear)},
               {"affine_offset", bespoke::to_json(first.affine.offset)},
               {"surface_fit", record.surface_fit_method},
               {"elastic", record.elastic_method},
               {"lambda", record.lambda},
               {"tolerance", record.tolerance},
               {"bake_error", bespoke::to_json(record.bake_error)},
               {"precision", name_of(first.pyramid.precision)},
               {"voxels", voxel_count(asset)},
               {"levels", levels_json(first.pyramid)},
               {"certificate", bespoke::to_json(whole_certificate(asset))},
               {"exact_map_bytes", asset.exact_map.size()},
               {"source", to_json(record.source)},
               {"target", to_json(record.target)},
               {"anchors", std::move(anchors)},
               {"options", embedded(record.options_json)},
               {"stages", embedded(record.stages_json)}};
  if (asset.steps.size() > 1) {
    // What above is the first step's alone stands here for every step.
    for (const char* key : {"affine_linear", "affine_offset", "levels"}) json.erase(key);
    json["steps"] = steps_json(asset);
  }
  return json.dump(2) + "\n";
}

}  // namespace bespoke
