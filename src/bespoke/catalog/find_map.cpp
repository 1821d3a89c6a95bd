#include "bespoke/catalog/find_map.h"

#include <algorithm>
#include <cctype>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/strings.h"

namespace bespoke {
namespace {

// Of 16 million values: two models of a catalogue of a thousand agree in them with a chance of 3 %, and then
// both are named.
constexpr std::size_t min_digits = 6;
constexpr std::size_t named_maps = 10;

void require_digits(const std::string& hash, const char* role) {
  const bool are_digits =
      std::all_of(hash.begin(), hash.end(), [](unsigned char c) { return std::isxdigit(c) != 0; });
  if (!are_digits || hash.size() < min_digits)
    throw InvalidInput(std::string("the ") + role + "'s hash \"" + hash + "\" is not of " +
                       std::to_string(min_digits) + " hexadecimal digits or more");
}

/// Whether all of them are copies of one file.
bool are_copies(const std::vector<const CatalogEntry*>& entries) {
  return !entries.front()->sha256.empty() &&
         std::all_of(entries.begin(), entries.end(),
                     [&](const CatalogEntry* entry) { return entry->sha256 == entries.front()->sha256; });
}

bool have_same_models(const std::vector<const CatalogEntry*>& entries) {
  return std::all_of(entries.begin(), entries.end(), [&](const CatalogEntry* entry) {
    return entry->source.hash == entries.front()->source.hash &&
           entry->target.hash == entries.front()->target.hash;
  });
}

std::string listed(const std::vector<const CatalogEntry*>& entries) {
  std::string text;
  for (std::size_t i = 0; i < std::min(named_maps, entries.size()); ++i)
    text += (i == 0 ? "" : ", ") + entries[i]->file + " (target " +
            entries[i]->target.hash.substr(0, 2 * min_digits) + ")";
  if (entries.size() > named_maps) text += " and " + std::to_string(entries.size() - named_maps) + " more";
  return text;
}

}  // namespace

const CatalogEntry& find_map(const Catalog& catalog, const ModelHashes& models) {
  require_digits(models.source, "source");
  if (!models.target.empty()) require_digits(models.target, "target");
  const std::string source = lower_case(models.source), target = lower_case(models.target);
  std::vector<const CatalogEntry*> from_source, found;
  for (const CatalogEntry& entry : catalog.assets) {
    if (!entry.source.hash.starts_with(source)) continue;
    from_source.push_back(&entry);
    if (entry.target.hash.starts_with(target)) found.push_back(&entry);
  }
  if (found.size() == 1) return *found.front();
  if (from_source.empty())
    throw InvalidInput("no map of the catalogue leads from the source " + source + "; it has " +
                       std::to_string(catalog.assets.size()) + " maps");
  if (found.empty())
    throw InvalidInput("no map leads from the source " + source + " to the target " + target +
                       "; from this source there are " + listed(from_source));
  if (are_copies(found)) return *found.front();
  if (have_same_models(found))
    throw InvalidInput(std::to_string(found.size()) + " maps lead from the source " + source +
                       " to the same target: " + listed(found) + "; give one of them as MAP, without --from");
  throw InvalidInput("the target must be named, or the map itself: from the source " + source +
                     " there are " + listed(found));
}

}  // namespace bespoke
