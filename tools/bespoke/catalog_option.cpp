#include "catalog_option.h"

#include <map>

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

/// By which the maps of the catalogue know a model: of its file, in either pose of a skinned one or, where
/// the file says a unit, of the model in the unit of a map. Where none knows it, of the file.
/// read(unit, hash): the model, in that unit, in the pose that has this hash, if one has.
template <class Read>
std::string known_hash(const Catalog& catalog, ModelRecord CatalogEntry::*side, const std::string& file,
                       const Read& read) {
  const std::string as_given = content_hash(read("", ""));
  const bool says_unit = !unit_of_format(file).empty(), is_posed = has_two_poses(file);
  std::map<std::string, std::string> in_unit;
  for (const CatalogEntry& entry : catalog.assets) {
    const std::string& known = (entry.*side).hash;
    if (known == as_given) return known;
    if (is_posed && content_hash(read(entry.unit, known)) == known) return known;
    if (!says_unit) continue;
    const auto [hash, is_new] = in_unit.try_emplace(entry.unit);
    if (is_new) hash->second = content_hash(read(entry.unit, ""));
    if (hash->second == known) return known;
  }
  return as_given;
}

/// Of the model, or as it is given.
std::string source_hash(const CatalogOption& option, const Catalog& catalog) {
  if (option.source.empty()) return option.source_hash;
  return known_hash(catalog, &CatalogEntry::source, option.source,
                    [&](const std::string& unit, const std::string& hash) {
                      return read_source(option.source, unit, hash);
                    });
}
std::string target_hash(const CatalogOption& option, const Catalog& catalog) {
  if (option.target.empty()) return option.target_hash;
  return known_hash(catalog, &CatalogEntry::target, option.target,
                    [&](const std::string& unit, const std::string& hash) {
                      return read_target(option.target, unit, hash);
                    });
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
