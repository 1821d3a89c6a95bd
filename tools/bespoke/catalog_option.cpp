#include "catalog_option.h"

#include "bespoke/catalog/catalog_file.h"
#include "bespoke/catalog/find_map.h"
#include "bespoke/cloud/target_model.h"
#include "bespoke/error.h"
#include "bespoke/sha256.h"
#include "planned_run.h"

namespace bespoke::command {
namespace {

/// Of the model, or as it is given.
std::string source_hash(const CatalogOption& option) {
  return option.source.empty() ? option.source_hash : content_hash(read_source(option.source));
}
std::string target_hash(const CatalogOption& option) {
  return option.target.empty() ? option.target_hash : content_hash(read_target(option.target));
}

}  // namespace

void add_catalog_option(CLI::App& app, CatalogOption& option) {
  app.add_option(
         "--from", option.directory,
         "Instead of MAP: find it in the catalogue of this directory (`bespoke catalog`), by its source "
         "and, where there are several, its target")
      ->type_name("DIR");
  app.add_option("--source", option.source, "With --from: the model that the product was made for")
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
  if (!option.is_used() && (names_source || names_target))
    throw CLI::ValidationError("--from", "is missing: a source or a target is sought in its catalogue");
  if (option.is_used() && option.source.empty() == option.source_hash.empty())
    throw CLI::ValidationError("--from", "needs either --source MESH or --source-hash HASH");
  if (!option.target.empty() && !option.target_hash.empty())
    throw CLI::ValidationError("--from", "takes either --target MESH or --target-hash HASH");
}

std::vector<JobFile> inputs(const CatalogOption& option) {
  if (!option.is_used()) return {};
  return named_files(
      {{"from", catalog_path(option.directory)}, {"source", option.source}, {"target", option.target}});
}

std::filesystem::path find_map(const CatalogOption& option) {
  const std::filesystem::path index = catalog_path(option.directory);
  const Catalog catalog = read_catalog(index);
  const CatalogEntry& entry = bespoke::find_map(catalog, {source_hash(option), target_hash(option)});
  const std::filesystem::path map = std::filesystem::path(option.directory) / entry.file;
  if (sha256_of_file(map) != entry.sha256)
    throw FormatError(map.string() + ": is not the file that " + index.string() +
                      " lists; `bespoke catalog " + option.directory + "` lists it anew");
  return map;
}

}  // namespace bespoke::command
