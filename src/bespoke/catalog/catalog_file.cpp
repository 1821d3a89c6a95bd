#include "bespoke/catalog/catalog_file.h"

#include <fstream>
#include <iterator>

#include "bespoke/error.h"
#include "bespoke/pipeline/summary_json.h"

namespace bespoke {
namespace {

constexpr const char* format_name = "bespoke catalog";
constexpr int format_version = 1;

Json model_json(const ModelRecord& model) { return {{"hash", model.hash}, {"box", to_json(model.box)}}; }

Json entry_json(const CatalogEntry& entry) {
  return {{"file", entry.file},
          {"sha256", entry.sha256},
          {"bytes", entry.bytes},
          {"unit", entry.unit},
          {"source", model_json(entry.source)},
          {"target", model_json(entry.target)},
          {"surface_fit", entry.surface_fit},
          {"elastic", entry.elastic},
          {"lambda", entry.lambda},
          {"tolerance", entry.tolerance},
          {"error", {{"p99", entry.error_p99}, {"max", entry.error_max}}},
          {"certificate",
           {{"bijection", entry.bijection},
            {"least_determinant", entry.min_determinant},
            {"undecided", entry.undecided},
            {"folded", entry.folded}}},
          {"steps", entry.steps},
          {"voxels", entry.voxels},
          {"anchors", entry.anchors},
          {"thumbnail", entry.thumbnail}};
}

Vector3 vector_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

ModelRecord model_of(const Json& json) {
  const Json& box = json.at("box");
  return {json.at("hash"), Box(vector_of(box.at("min")), vector_of(box.at("max")))};
}

CatalogEntry entry_of(const Json& json) {
  const Json& certificate = json.at("certificate");
  return {json.at("file"),
          json.at("sha256"),
          json.at("bytes"),
          json.at("unit"),
          model_of(json.at("source")),
          model_of(json.at("target")),
          json.at("surface_fit"),
          json.at("elastic"),
          json.at("lambda"),
          json.at("tolerance"),
          json.at("error").at("p99"),
          json.at("error").at("max"),
          certificate.at("bijection"),
          certificate.at("least_determinant"),
          certificate.at("undecided"),
          certificate.at("folded"),
          json.at("steps"),
          json.at("voxels"),
          json.at("anchors"),
          json.at("thumbnail")};
}

std::string how_to_make(const std::filesystem::path& path) {
  return "; `bespoke catalog " + path.parent_path().string() + "` makes it anew";
}

}  // namespace

std::filesystem::path catalog_path(const std::filesystem::path& directory) {
  return directory / "catalog.json";
}

std::string catalog_json(const Catalog& catalog) {
  Json assets = Json::array(), refused = Json::array();
  for (const CatalogEntry& entry : catalog.assets) assets.push_back(entry_json(entry));
  for (const RefusedFile& file : catalog.refused)
    refused.push_back({{"file", file.file}, {"reason", file.reason}});
  const Json json = {{"format", format_name},
                     {"version", format_version},
                     {"assets", std::move(assets)},
                     {"refused", std::move(refused)},
                     {"others", catalog.others}};
  // File names need not be UTF-8.
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Catalog read_catalog(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path))
    throw FileError(path.string() + ": cannot be read" + how_to_make(path));
  try {
    const Json json = Json::parse(file);
    if (json.at("format") != format_name || json.at("version") != format_version)
      throw FormatError(path.string() + ": is a catalogue of another version" + how_to_make(path));
    Catalog catalog;
    for (const Json& entry : json.at("assets")) catalog.assets.push_back(entry_of(entry));
    for (const Json& refused : json.at("refused"))
      catalog.refused.push_back({refused.at("file"), refused.at("reason")});
    for (const Json& other : json.at("others")) catalog.others.push_back(other);
    return catalog;
  } catch (const Json::exception&) {
    throw FormatError(path.string() + ": is no catalogue of assets" + how_to_make(path));
  }
}

}  // namespace bespoke
