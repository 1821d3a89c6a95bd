#include "bespoke/catalog/record_difference.h"

#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "bespoke/pipeline/summary_json.h"

namespace bespoke {
namespace {

using Fields = std::vector<std::pair<std::string, std::string>>;  // name, JSON

/// Every value of nested objects under its path; lists are values.
void flatten(const Json& json, const std::string& path, Fields& fields) {
  if (!json.is_object()) {
    fields.emplace_back(path, json.dump());
    return;
  }
  for (const auto& [key, value] : json.items()) flatten(value, path.empty() ? key : path + "." + key, fields);
}

Fields fields_of(const Asset& asset) {
  const AssetRecord& record = asset.record;
  const Json json = {{"unit", record.unit},
                     {"source", record.source.hash},
                     {"target", record.target.hash},
                     {"surface_fit", record.surface_fit_method},
                     {"elastic", record.elastic_method},
                     {"lambda", record.lambda},
                     {"tolerance", record.tolerance},
                     {"precision", name_of(asset.steps.front().pyramid.precision)},
                     {"path", name_of(rotation_paths, asset.path)},
                     {"steps", asset.steps.size()},
                     {"exact_map", !asset.exact_map.empty()}};
  Fields fields;
  flatten(json, "", fields);
  if (!record.options_json.empty()) flatten(Json::parse(record.options_json), "options", fields);
  // Options that say again what stands above would be told twice.
  std::erase_if(fields, [&](const Fields::value_type& field) {
    constexpr std::string_view prefix = "options.";
    const std::string name = field.first.starts_with(prefix) ? field.first.substr(prefix.size()) : "";
    return json.contains(name) && json[name].dump() == field.second;
  });
  return fields;
}

std::string value_at(const Fields& fields, const std::string& name) {
  for (const auto& [known, value] : fields)
    if (known == name) return value;
  return {};
}

std::map<std::string, const AnchorRecord*> by_name(const std::vector<AnchorRecord>& anchors) {
  std::map<std::string, const AnchorRecord*> found;
  for (std::size_t i = 0; i < anchors.size(); ++i)
    found[anchors[i].name.empty() ? std::to_string(i + 1) : anchors[i].name] = &anchors[i];
  return found;
}

std::vector<AnchorDifference> anchor_differences(const Asset& a, const Asset& b) {
  const auto of_a = by_name(a.record.anchors), of_b = by_name(b.record.anchors);
  std::set<std::string> names;
  for (const auto* anchors : {&of_a, &of_b})
    for (const auto& [name, anchor] : *anchors) names.insert(name);
  std::vector<AnchorDifference> differences;
  for (const std::string& name : names) {
    AnchorDifference found{name, of_a.contains(name), of_b.contains(name)};
    if (found.in_a && found.in_b) {
      const AnchorRecord &in_a = *of_a.at(name), &in_b = *of_b.at(name);
      found.moved_source = (in_a.a - in_b.a).norm();
      found.moved_target = (in_a.b - in_b.b).norm();
      found.other_accuracy = in_a.weight != in_b.weight || in_a.sigma != in_b.sigma;
      if (found.moved_source == 0 && found.moved_target == 0 && !found.other_accuracy) continue;
    }
    differences.push_back(found);
  }
  return differences;
}

}  // namespace

RecordDifference record_difference(const Asset& a, const Asset& b) {
  const Fields of_a = fields_of(a), of_b = fields_of(b);
  RecordDifference difference;
  for (const auto& [name, value] : of_a)
    if (const std::string other = value_at(of_b, name); other != value)
      difference.fields.push_back({name, value, other});
  for (const auto& [name, value] : of_b)
    if (value_at(of_a, name).empty()) difference.fields.push_back({name, "", value});
  difference.anchors = anchor_differences(a, b);
  return difference;
}

}  // namespace bespoke
