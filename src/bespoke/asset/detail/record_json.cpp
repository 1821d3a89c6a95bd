#include "bespoke/asset/detail/record_json.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "bespoke/error.h"
#include "bespoke/json_reason.h"

namespace bespoke {
namespace {

using Json = nlohmann::ordered_json;

// Deeper JSON than any record has could exhaust the stack of a recursive reader.
constexpr int max_depth = 64;

Json to_json(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

Json to_json(const Matrix3& m) {
  Json rows = Json::array();
  for (int i = 0; i < 3; ++i) rows.push_back(to_json(Vector3(m.row(i))));
  return rows;
}

Json to_json(const AffineMap& affine) {
  return {{"linear", to_json(affine.linear)}, {"offset", to_json(affine.offset)}};
}

Json to_json(const Statistics& s) {
  return {{"count", s.count}, {"min", s.min}, {"median", s.median},
          {"p95", s.p95},     {"p99", s.p99}, {"max", s.max}};
}

Json to_json(const ModelRecord& model) {
  return {{"hash", model.hash},
          {"box", {{"min", to_json(model.box.min())}, {"max", to_json(model.box.max())}}}};
}

Json to_json(const Certificate& c) {
  Json places = Json::array();
  for (const FoldedCell& cell : c.places)
    places.push_back(
        {{"level", cell.level}, {"center", to_json(cell.center)}, {"determinant", cell.determinant}});
  return {{"certified", c.certified},
          {"undecided", c.undecided},
          {"folded", c.folded},
          {"least_determinant", c.min_determinant},
          {"affine_determinant", c.affine_determinant},
          {"places", std::move(places)}};
}

Json to_json(const AnchorRecord& anchor) {
  Json json = {{"name", anchor.name},
               {"a", to_json(anchor.a)},
               {"b", to_json(anchor.b)},
               {"weight", std::isinf(anchor.weight) ? Json("exact") : Json(anchor.weight)},
               {"residual", anchor.residual}};
  // Only where it is not 0: a program that knows nothing of it finds what it has always found.
  if (anchor.sigma > 0) json["sigma"] = anchor.sigma;
  return json;
}

Json to_json(const Pyramid& pyramid) {
  Json levels = Json::array();
  for (const PyramidLevel& level : pyramid.levels)
    levels.push_back({{"voxel_size", level.voxel_size}, {"leaves", level.leaves.size()}});
  Json json = {{"origin", to_json(pyramid.origin)}, {"levels", std::move(levels)}};
  // Only where it is not single, so that all other assets stay what version 1 has been from the beginning.
  if (pyramid.precision != ValuePrecision::single) json["precision"] = name_of(pyramid.precision);
  return json;
}

Json parse(std::string_view text) {
  return Json::parse(text, [](int depth, Json::parse_event_t, Json&) {
    if (depth > max_depth)
      throw FormatError("JSON nests deeper than " + std::to_string(max_depth) + " levels");
    return true;
  });
}

Json embedded(const std::string& text, const char* what, Json when_empty) {
  if (text.empty()) return when_empty;
  try {
    Json json = parse(text);
    if (json.type() != when_empty.type())
      throw InvalidInput(std::string(what) + " must be a JSON " + when_empty.type_name());
    return json;
  } catch (const Json::exception& error) {
    throw InvalidInput(std::string(what) + " is not JSON: " + json_reason(error.what()));
  }
}

std::string dump(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// A value of the record with the way to it, so that messages name what is wrong.
class Field {
 public:
  Field(const Json& json, std::string path) : json_(json), path_(std::move(path)) {}

  Field operator[](const char* key) const {
    if (!json_.is_object()) fail("is not an object");
    const auto found = json_.find(key);
    const std::string path = path_ + "." + key;
    if (found == json_.end()) throw FormatError(path + " is missing");
    return {*found, path};
  }
  bool has(const char* key) const { return json_.is_object() && json_.contains(key); }
  std::vector<Field> items() const {
    if (!json_.is_array()) fail("is not an array");
    std::vector<Field> fields;
    for (const Json& item : json_)
      fields.emplace_back(item, path_ + "[" + std::to_string(fields.size()) + "]");
    return fields;
  }
  double number() const {
    if (!json_.is_number()) fail("is not a number");
    const double value = json_.get<double>();
    if (!std::isfinite(value)) fail("is not finite");
    return value;
  }
  std::size_t count() const {
    if (!json_.is_number_integer() || (!json_.is_number_unsigned() && json_.get<std::int64_t>() < 0))
      fail("is not a count");
    const auto value = json_.get<std::uint64_t>();
    if (value > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) fail("is too large");
    return static_cast<std::size_t>(value);
  }
  std::string text() const {
    if (!json_.is_string()) fail("is not a string");
    return json_.get<std::string>();
  }
  bool is(const char* text) const { return json_.is_string() && json_.get<std::string>() == text; }
  Vector3 vector() const {
    const auto coordinates = items();
    if (coordinates.size() != 3) fail("has not three coordinates");
    return {coordinates[0].number(), coordinates[1].number(), coordinates[2].number()};
  }
  Matrix3 matrix() const {
    const auto rows = items();
    if (rows.size() != 3) fail("has not three rows");
    Matrix3 matrix;
    for (int i = 0; i < 3; ++i) matrix.row(i) = rows[static_cast<std::size_t>(i)].vector().transpose();
    return matrix;
  }
  std::string dumped(Json::value_t type) const {
    if (json_.type() != type) fail("has the wrong type");
    return dump(json_);
  }
  [[noreturn]] void fail(const char* what) const { throw FormatError(path_ + " " + what); }

 private:
  const Json& json_;
  std::string path_;
};

Statistics parse_statistics(const Field& field) {
  return {field["count"].count(), field["min"].number(), field["median"].number(),
          field["p95"].number(),  field["p99"].number(), field["max"].number()};
}

ModelRecord parse_model(const Field& field) {
  ModelRecord model;
  model.hash = field["hash"].text();
  model.box = Box(field["box"]["min"].vector(), field["box"]["max"].vector());
  return model;
}

Certificate parse_certificate(const Field& field) {
  Certificate certificate;
  certificate.certified = field["certified"].count();
  certificate.undecided = field["undecided"].count();
  certificate.folded = field["folded"].count();
  certificate.min_determinant = field["least_determinant"].number();
  certificate.affine_determinant = field["affine_determinant"].number();
  for (const Field& place : field["places"].items())
    certificate.places.push_back(
        {static_cast<int>(place["level"].count()), place["center"].vector(), place["determinant"].number()});
  return certificate;
}

AnchorRecord parse_anchor(const Field& field) {
  AnchorRecord anchor;
  anchor.name = field["name"].text();
  anchor.a = field["a"].vector();
  anchor.b = field["b"].vector();
  const Field weight = field["weight"];
  anchor.weight = weight.is("exact") ? std::numeric_limits<double>::infinity() : weight.number();
  anchor.residual = field["residual"].number();
  if (field.has("sigma")) anchor.sigma = field["sigma"].number();
  return anchor;
}

RotationPath parse_path(const Field& field) {
  if (const auto path = value_of(rotation_paths, field.text())) return *path;
  field.fail("is none of geodesic, euler and flow");
}

ValuePrecision parse_precision(const Field& pyramid) {
  if (!pyramid.has("precision")) return ValuePrecision::single;
  const Field field = pyramid["precision"];
  if (!field.is(name_of(ValuePrecision::half))) field.fail("is not half; single is not written");
  return ValuePrecision::half;
}

/// A step of which the pyramid's levels are still missing, and those levels.
std::vector<LevelRecord> parse_step(const Field& field, MapStep& step) {
  step.affine.linear = field["affine"]["linear"].matrix();
  step.affine.offset = field["affine"]["offset"].vector();
  step.certificate = parse_certificate(field["certificate"]);
  step.pyramid.origin = field["pyramid"]["origin"].vector();
  step.pyramid.precision = parse_precision(field["pyramid"]);
  std::vector<LevelRecord> levels;
  for (const Field& level : field["pyramid"]["levels"].items())
    levels.push_back({level["voxel_size"].number(), level["leaves"].count()});
  return levels;
}

ParsedRecord parse_fields(const Field& field) {
  ParsedRecord parsed;
  Asset& asset = parsed.asset;
  asset.target_from_source.rotation = field["rigid"]["rotation"].matrix();
  asset.target_from_source.translation = field["rigid"]["translation"].vector();
  asset.path = parse_path(field["rotation_path"]);
  AssetRecord& record = asset.record;
  record.unit = field["unit"].text();
  record.elastic_method = field["elastic_method"].text();
  record.surface_fit_method = field["surface_fit_method"].text();
  record.lambda = field["lambda"].number();
  record.tolerance = field["tolerance"].number();
  record.bake_error = parse_statistics(field["bake_error"]);
  record.options_json = field["options"].dumped(Json::value_t::object);
  record.stages_json = field["stages"].dumped(Json::value_t::array);
  for (const Field& anchor : field["anchors"].items()) record.anchors.push_back(parse_anchor(anchor));
  record.source = parse_model(field["source"]);
  record.target = parse_model(field["target"]);
  const bool chain = field.has("steps");
  const std::vector<Field> steps = chain ? field["steps"].items() : std::vector<Field>{field};
  if (chain && steps.size() < 2) field["steps"].fail("has not two steps; one is written as version 1");
  asset.steps.resize(steps.size());
  for (std::size_t k = 0; k < steps.size(); ++k)
    parsed.levels.push_back(parse_step(steps[k], asset.steps[k]));
  return parsed;
}

}  // namespace

std::string record_json(const Asset& asset) {
  const AssetRecord& record = asset.record;
  Json anchors = Json::array();
  for (const AnchorRecord& anchor : record.anchors) anchors.push_back(to_json(anchor));
  // One step keeps the places that version 1 gave it.
  const MapStep* only = asset.steps.size() == 1 ? &asset.steps.front() : nullptr;
  Json json = {{"unit", record.unit},
               {"rigid",
                {{"rotation", to_json(asset.target_from_source.rotation)},
                 {"translation", to_json(asset.target_from_source.translation)}}},
               {"rotation_path", name_of(rotation_paths, asset.path)}};
  if (only) json["affine"] = to_json(only->affine);
  json.update({{"elastic_method", record.elastic_method},
               {"surface_fit_method", record.surface_fit_method},
               {"lambda", record.lambda},
               {"tolerance", record.tolerance},
               {"bake_error", to_json(record.bake_error)}});
  if (only) json["certificate"] = to_json(only->certificate);
  json.update({{"options", embedded(record.options_json, "options_json", Json::object())},
               {"stages", embedded(record.stages_json, "stages_json", Json::array())},
               {"anchors", std::move(anchors)},
               {"source", to_json(record.source)},
               {"target", to_json(record.target)}});
  if (only) {
    json["pyramid"] = to_json(only->pyramid);
  } else {
    for (const MapStep& step : asset.steps)
      json["steps"].push_back({{"affine", to_json(step.affine)},
                               {"certificate", to_json(step.certificate)},
                               {"pyramid", to_json(step.pyramid)}});
  }
  return dump(json);
}

ParsedRecord parse_record(std::string_view json) {
  try {
    const Json parsed = parse(json);
    return parse_fields(Field(parsed, "record"));
  } catch (const Json::exception& error) {
    throw FormatError(std::string("the record is not JSON: ") + json_reason(error.what()));
  }
}

std::string step_prefix(std::size_t step) {
  std::ostringstream prefix;
  if (step > 0) prefix << 's' << step << '_';
  return prefix.str();
}

namespace {

constexpr const char* one_step_convention =
    "column vectors; E(x) = affine_offset + affine x + u_0(x) + u_1(x) + ... with x in the source frame, "
    "each u "
    "trilinear between its nodes and 0 outside its leaves; Psi(t)(x) = R(t) ((1-t) x + t E(x)) + t T, "
    "R(1) = rotation, T = translation";

constexpr const char* chain_convention =
    "column vectors; E = E_K after ... after E_1, all in the source frame; the first step takes x to "
    "affine_offset + affine x + u_0(x) + u_1(x) + ..., the second likewise with s1_affine_offset, s1_affine, "
    "s1_u_0, s1_u_1, ..., and so on; each u is trilinear between its nodes and 0 outside its leaves; "
    "Psi(1)(x) = rotation E(x) + translation";

void add_step(const MapStep& step, std::size_t levels, const std::string& prefix, Metadata& metadata) {
  for (int i = 0; i < 3; ++i)
    metadata[prefix + "affine_row_" + std::to_string(i)] = Vector3(step.affine.linear.row(i));
  metadata[prefix + "affine_offset"] = step.affine.offset;
  metadata[prefix + "cells_certified"] = static_cast<std::int64_t>(step.certificate.certified);
  metadata[prefix + "cells_undecided"] = static_cast<std::int64_t>(step.certificate.undecided);
  metadata[prefix + "cells_folded"] = static_cast<std::int64_t>(step.certificate.folded);
  metadata[prefix + "least_determinant"] = step.certificate.min_determinant;
  metadata[prefix + "affine_determinant"] = step.certificate.affine_determinant;
  metadata[prefix + "levels"] = static_cast<std::int64_t>(levels);
}

}  // namespace

Metadata file_metadata(const std::string& json) {
  const auto [asset, levels] = parse_record(json);
  const AssetRecord& record = asset.record;
  const bool chain = asset.steps.size() > 1;
  Metadata metadata;
  metadata[version_key] = chain ? chain_version : one_step_version;
  metadata[record_key] = json;
  metadata["bespoke:direction"] = std::string("maps points a to b");
  metadata["bespoke:convention"] = std::string(chain ? chain_convention : one_step_convention);
  metadata["bespoke:unit"] = record.unit;
  for (int i = 0; i < 3; ++i)
    metadata["bespoke:rotation_row_" + std::to_string(i)] = Vector3(asset.target_from_source.rotation.row(i));
  metadata["bespoke:translation"] = asset.target_from_source.translation;
  metadata["bespoke:rotation_path"] = std::string(name_of(rotation_paths, asset.path));
  metadata["bespoke:elastic_method"] = record.elastic_method;
  metadata["bespoke:surface_fit_method"] = record.surface_fit_method;
  metadata["bespoke:lambda"] = record.lambda;
  metadata["bespoke:tolerance"] = record.tolerance;
  metadata["bespoke:error_max"] = record.bake_error.max;
  metadata["bespoke:error_p99"] = record.bake_error.p99;
  if (asset.steps.front().pyramid.precision != ValuePrecision::single)
    metadata["bespoke:precision"] = std::string(name_of(asset.steps.front().pyramid.precision));
  for (std::size_t k = 0; k < asset.steps.size(); ++k)
    add_step(asset.steps[k], levels[k].size(), "bespoke:" + step_prefix(k), metadata);
  metadata["bespoke:is_bijection"] = whole_certificate(asset).is_bijection();
  if (chain) metadata["bespoke:steps"] = static_cast<std::int64_t>(asset.steps.size());
  for (const auto& [side, model] : {std::pair("source", record.source), std::pair("target", record.target)}) {
    const std::string prefix = std::string("bespoke:") + side;
    metadata[prefix + "_hash"] = model.hash;
    metadata[prefix + "_box_min"] = Vector3(model.box.min());
    metadata[prefix + "_box_max"] = Vector3(model.box.max());
  }
  return metadata;
}

}  // namespace bespoke
