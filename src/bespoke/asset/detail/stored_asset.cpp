#include "bespoke/asset/detail/stored_asset.h"

#include <new>

#include "bespoke/asset/detail/require_format.h"
#include "bespoke/error.h"

namespace bespoke {
namespace {

constexpr std::size_t longest_reason = 200;
constexpr std::size_t longest_path = 80;

/// One line of printable characters.
std::string one_line(std::string text, std::size_t longest) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  if (text.size() > longest) text = text.substr(0, longest - 3) + "...";
  return text;
}

/// The plain entries repeat the record for other programs; where the two differ, programs would disagree
/// about the map.
void require_same_metadata(const Metadata& found, const std::string& record) {
  const Metadata expected = file_metadata(record);
  for (const auto& [key, value] : expected) {
    const auto entry = found.find(key);
    require_format(entry != found.end(), "metadata " + key + " is missing");
    require_format(entry->second == value, "metadata " + key + " contradicts the record");
  }
  for (const auto& [key, value] : found)
    require_format(expected.count(key) > 0, "unexpected metadata " + key);
}

std::string record_of(const Metadata& metadata) {
  const auto version = metadata.find(version_key);
  require_format(version != metadata.end(),
                 std::string("metadata ") + version_key + " is missing: not a bespoke asset");
  const auto* number = std::get_if<std::int64_t>(&version->second);
  require_format(number != nullptr, std::string("metadata ") + version_key + " is not a 64-bit integer");
  require_format(*number == one_step_version || *number == chain_version,
                 "format version " + std::to_string(*number) + "; this program reads versions " +
                     std::to_string(one_step_version) + " and " + std::to_string(chain_version));
  const auto record = metadata.find(record_key);
  require_format(record != metadata.end() && std::holds_alternative<std::string>(record->second),
                 std::string("metadata ") + record_key + " is missing");
  return std::get<std::string>(record->second);
}

}  // namespace

std::string level_name(std::size_t step, std::size_t level) {
  return step_prefix(step) + "u_" + std::to_string(level);
}

std::string checked_record(const Metadata& metadata) {
  std::string record = record_of(metadata);
  require_same_metadata(metadata, record);
  return record;
}

void require_grid_count(std::size_t grids, const ParsedRecord& record) {
  std::size_t count = preview_count;
  for (const std::vector<LevelRecord>& levels : record.levels) count += levels.size();
  require_format(grids >= count && grids <= count + distance_count,
                 "has " + std::to_string(grids) + " grids, the record requires " + std::to_string(count));
}

void require_level(const StoredGrid& grid, const std::string& name, const Pyramid& pyramid,
                   double voxel_size) {
  require_format(grid.name == name, "grid " + grid.name + " stands in the place of " + name);
  require_format(grid.components == 3 && grid.grid_class == GridClass::unknown,
                 "grid " + grid.name + " is no Vec3S grid");
  require_format(grid.voxel_size == voxel_size && grid.origin == pyramid.origin,
                 "the transform of grid " + grid.name + " contradicts the record");
  require_format(grid.half == (pyramid.precision == ValuePrecision::half),
                 "the precision of grid " + grid.name + " contradicts the record");
  require_format(grid.background == 0, "the background of grid " + grid.name + " is not 0");
  require_format(grid.active.empty(), "grid " + grid.name + " has inactive nodes in its leaves");
  require_format(grid.metadata.empty(), "grid " + grid.name + " has unexpected metadata");
}

void require_leaf_count(std::size_t leaves, const std::string& name, const LevelRecord& record) {
  require_format(leaves == record.leaves, "grid " + name + " has " + std::to_string(leaves) +
                                              " leaves, the record says " + std::to_string(record.leaves));
}

std::string name_for_message(const std::filesystem::path& path) {
  const std::string name = path.string();
  return name.size() <= longest_path ? name : "..." + name.substr(name.size() - longest_path + 3);
}

void rethrow_naming(const std::filesystem::path& path) {
  try {
    throw;
  } catch (const FileError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw MemoryLimitError(name_for_message(path) + ": does not fit into memory");
  } catch (const std::exception& error) {
    throw FormatError(name_for_message(path) + ": " + one_line(error.what(), longest_reason));
  }
}

}  // namespace bespoke
