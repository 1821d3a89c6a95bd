#include "catalog_option.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "bespoke/catalog/catalog_file.h"
#include "bespoke/catalog/find_map.h"
#include "bespoke/cloud/target_model.h"
#include "bespoke/error.h"
#include "bespoke/product/format_unit.h"
#include "bespoke/product/posed_product.h"
#include "bespoke/sha256.h"
#include "planned_run.h"

namespace bespoke::command {
namespace {

/// Hashes by which a catalogue may know a model's file: in each pose of a skinned one, as the file has it or
/// in the unit of a map. Each pose is read once, each unit hashed once.
class ModelHashes {
 public:
  /// read(pose): the model, a TargetModel.
  template <class Read>
  ModelHashes(std::filesystem::path file, const Read& read) : file_(std::move(file)) {
    models_.push_back(read(ModelPose::shown));
    if (has_two_poses(file_)) models_.push_back(read(ModelPose::stored));
    for (const TargetModel& model : models_) as_given_.push_back(content_hash(model));
  }

  const std::string& shown() const { return as_given_.front(); }

  bool contain(const std::string& hash, const std::string& unit) {
    if (is_among(hash, as_given_)) return true;
    const double scale = scale_to_unit(file_, unit);
    if (scale == 1) return false;
    const auto [of_unit, is_new] = in_unit_.try_emplace(unit);
    if (is_new)
      for (const TargetModel& model : models_)
        of_unit->second.push_back(content_hash(TriangleMesh{scale * model.mesh.vertices, model.mesh.faces}));
    return is_among(hash, of_unit->second);
  }

 private:
  static bool is_among(const std::string& hash, const std::vector<std::string>& hashes) {
    return std::find(hashes.begin(), hashes.end(), hash) != hashes.end();
  }

  std::filesystem::path file_;
  std::vector<TargetModel> models_;
  std::vector<std::string> as_given_;
  std::map<std::string, std::vector<std::string>> in_unit_;
};

/// The one of the model by which a map of the catalogue knows it; where none does, that of its file.
std::string known_hash(const Catalog& catalog, ModelRecord CatalogEntry::*side, ModelHashes model) {
  for (const CatalogEntry& entry : catalog.assets)
    if (model.contain((entry.*side).hash, entry.unit)) return (entry.*side).hash;
  return model.shown();
}

/// Of the model, or as it is given.
std::string source_hash(const CatalogOption& option, const Catalog& catalog) {
  if (option.source.empty()) return option.source_hash;
  const auto read = [&](ModelPose pose) {
    return TargetModel{read_source_model(option.source, pose).mesh, std::nullopt, {}};
  };
  return known_hash(catalog, &CatalogEntry::source, {option.source, read});
}
std::string target_hash(const CatalogOption& option, const Catalog& catalog) {
  if (option.target.empty()) return option.target_hash;
  const auto read = [&](ModelPose pose) { return read_target(option.target, pose); };
  return known_hash(catalog, &CatalogEntry::target, {option.target, read});
}

/// With a map that is named: what products are checked against.
bool names_both_models(const CatalogOption& option) {
  return !option.source.empty() && !option.target.empty() && option.source_hash.empty() &&
         option.target_hash.empty();
}

}  // namespace

void add_catalog_option(CLI::App& app, CatalogOption& option) {
  app.add_option(
         "--from", option.directory,
         "Instead of MAP: find the map in the catalogue of this directory (`bespoke catalog`), by its source "
         "and, where there are several, its target")
      ->type_name("DIR");
  app.add_option(
         "--source", option.source,
         "With --from: the model that the product was made for. With both models, also of a MAP, products "
         "that penetrate the target are warned of")
      ->type_name("MESH");
  app.add_option("--source-hash", option.source_hash,
                 "With --from: the first digits of its hash, as `info` prints it")
      ->type_name("HASH");
  app.add_option("--target", option.target, "With --from: the model that the product goes to")
      ->type_name("MESH");
  app.add_option("--target-hash", option.target_hash, "With --from: the first digits of its hash")
      ->type_name("HASH");
}

void require_valid(const CatalogOption& option) {
  const bool names_source = !option.source.empty() || !option.source_hash.empty();
  const bool names_target = !option.target.empty() || !option.target_hash.empty();
  if (!option.is_used() && names_both_models(option)) return;
  if (!option.is_used() && (names_source || names_target))
    throw CLI::ValidationError(
        "--from",
        "is missing: a source or a target is sought in its catalogue; with a MAP, both "
        "--source and --target are what products are checked against");
  if (option.is_used() && option.source.empty() == option.source_hash.empty())
    throw CLI::ValidationError("--from", "needs either --source MESH or --source-hash HASH");
  if (!option.target.empty() && !option.target_hash.empty())
    throw CLI::ValidationError("--from", "takes either --target MESH or --target-hash HASH");
}

std::vector<JobFile> inputs(const CatalogOption& option) {
  std::vector<JobFile> files = named_files({{"source", option.source}, {"target", option.target}});
  if (option.is_used()) files.insert(files.begin(), {"from", catalog_path(option.directory)});
  return files;
}

std::filesystem::path find_map(const CatalogOption& option) {
  const std::filesystem::path index = catalog_path(option.directory);
  const Catalog catalog = read_catalog(index);
  const CatalogEntry& entry =
      bespoke::find_map(catalog, {source_hash(option, catalog), target_hash(option, catalog)});
  const std::filesystem::path map = std::filesystem::path(option.directory) / entry.file;
  if (sha256_of_file(map) != entry.sha256)
    throw FormatError(map.string() + ": is not the file that " + index.string() +
                      " lists; `bespoke catalog " + option.directory + "` lists it anew");
  return map;
}

}  // namespace bespoke::command
