#include "bespoke/catalog/difference_report.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <sstream>

#include "bespoke/number_format.h"
#include "bespoke/pipeline/summary_json.h"

namespace bespoke {
namespace {

constexpr std::size_t printed_anchors = 10;  // JSON has all

std::string figure(double value) { return format_number(value, 4); }

std::string tuple(const Vector3& v) { return format_number(v, 6); }

struct NearAnchor {
  std::string name;
  double distance = std::numeric_limits<double>::infinity();
};

/// The anchor of A with a name that lies nearest to a point of the source's space.
std::optional<NearAnchor> nearest_anchor(const Asset& a, const Vector3& x) {
  NearAnchor nearest;
  for (const AnchorRecord& anchor : a.record.anchors) {
    const double distance = (anchor.a - x).norm();
    if (!anchor.name.empty() && distance < nearest.distance) nearest = {anchor.name, distance};
  }
  return nearest.name.empty() ? std::nullopt : std::optional(nearest);
}

std::string unit_text(const ComparedMaps& compared) {
  const std::string& unit = compared.a.record.unit;
  return unit == "unknown" ? "mesh units" : unit;
}

std::string largest_text(const ComparedMaps& compared, const PointDifference& difference) {
  if (difference.distance.max == 0) return {};
  std::string text = "  largest at " + tuple(difference.largest) + ", which A takes to " +
                     tuple(difference.image_a) + " and B to " + tuple(difference.image_b);
  if (const auto anchor = nearest_anchor(compared.a, difference.largest))
    text += "; " + figure(anchor->distance) + " from anchor \"" + anchor->name + "\"";
  return text + "\n";
}

std::string anchor_text(const AnchorDifference& anchor) {
  std::string text = "  anchor \"" + anchor.name + "\": ";
  if (!anchor.in_b) return text + "in A only\n";
  if (!anchor.in_a) return text + "in B only\n";
  if (anchor.moved_source > 0) text += "moved by " + figure(anchor.moved_source) + " on the source; ";
  if (anchor.moved_target > 0) text += "moved by " + figure(anchor.moved_target) + " on the target; ";
  if (anchor.other_accuracy) text += "of another accuracy; ";
  text.erase(text.size() - 2);
  return text + "\n";
}

std::string record_text(const RecordDifference& records) {
  if (records.is_empty()) return "records      the same\n";
  std::string text = "records      differ\n";
  for (const FieldDifference& field : records.fields)
    text += "  " + field.name + ": " + (field.a.empty() ? "not in A" : field.a) + " | " +
            (field.b.empty() ? "not in B" : field.b) + "\n";
  const std::size_t printed = std::min(printed_anchors, records.anchors.size());
  for (std::size_t i = 0; i < printed; ++i) text += anchor_text(records.anchors[i]);
  if (records.anchors.size() > printed)
    text += "  and " + std::to_string(records.anchors.size() - printed) + " more anchors\n";
  return text;
}

std::string map_text(const Asset& asset) {
  const Certificate certificate = whole_certificate(asset);
  const std::string proof =
      certificate.is_bijection()
          ? "proved a bijection, least determinant " + figure(certificate.min_determinant)
          : "not proved: " + std::to_string(certificate.folded) + " cells fold, " +
                std::to_string(certificate.undecided) + " are undecided";
  return proof + "; bake error p99 " + figure(asset.record.bake_error.p99) + ", max " +
         figure(asset.record.bake_error.max) + "; " + std::to_string(voxel_count(asset)) + " voxels\n";
}

Json difference_json(const ComparedMaps& compared, const PointDifference& difference) {
  Json largest = {{"at", to_json(difference.largest)},
                  {"a", to_json(difference.image_a)},
                  {"b", to_json(difference.image_b)}};
  if (const auto anchor = nearest_anchor(compared.a, difference.largest)) {
    largest["nearest_anchor"] = anchor->name;
    largest["anchor_distance"] = anchor->distance;
  }
  return {{"distance", to_json(difference.distance)},
          {"largest", std::move(largest)},
          {"without_rigid_parts", to_json(difference.elastic)}};
}

Json map_json(const Asset& asset) {
  const Certificate certificate = whole_certificate(asset);
  return {{"bijection", certificate.is_bijection()},
          {"min_determinant", certificate.min_determinant},
          {"undecided", certificate.undecided},
          {"folded", certificate.folded},
          {"bake_error", to_json(asset.record.bake_error)},
          {"voxels", voxel_count(asset)}};
}

Json records_json(const RecordDifference& records) {
  Json fields = Json::array(), anchors = Json::array();
  const auto value = [](const std::string& json) { return json.empty() ? Json() : Json::parse(json); };
  for (const FieldDifference& field : records.fields)
    fields.push_back({{"name", field.name}, {"a", value(field.a)}, {"b", value(field.b)}});
  for (const AnchorDifference& anchor : records.anchors)
    anchors.push_back({{"name", anchor.name},
                       {"in_a", anchor.in_a},
                       {"in_b", anchor.in_b},
                       {"moved_source", anchor.moved_source},
                       {"moved_target", anchor.moved_target},
                       {"other_accuracy", anchor.other_accuracy}});
  return {{"fields", std::move(fields)}, {"anchors", std::move(anchors)}};
}

}  // namespace

std::string difference_text(const ComparedMaps& compared) {
  const MapDifference& maps = compared.maps;
  std::ostringstream text;
  text << "distance     " << to_string(maps.band.distance) << ", " << unit_text(compared) << '\n'
       << largest_text(compared, maps.band) << "  without rigid parts " << to_string(maps.band.elastic)
       << "\n  affine parts at most " << figure(maps.affine) << " apart over the source's box\n";
  for (std::size_t i = 0; i < maps.products.size(); ++i)
    text << compared.products[i] << "  " << to_string(maps.products[i].distance) << '\n'
         << largest_text(compared, maps.products[i]);
  text << "A            " << map_text(compared.a) << "B            " << map_text(compared.b)
       << record_text(compared.records);
  return text.str();
}

std::string difference_json(const ComparedMaps& compared) {
  Json products = Json::array();
  for (std::size_t i = 0; i < compared.products.size(); ++i) {
    Json product = {{"name", compared.products[i]}};
    product.update(difference_json(compared, compared.maps.products[i]));
    products.push_back(std::move(product));
  }
  Json json = {{"unit", compared.a.record.unit}};
  json.update(difference_json(compared, compared.maps.band));
  json["affine_distance"] = compared.maps.affine;
  json["products"] = std::move(products);
  json["a"] = map_json(compared.a);
  json["b"] = map_json(compared.b);
  json["records"] = records_json(compared.records);
  return json.dump(2) + "\n";
}

}  // namespace bespoke
