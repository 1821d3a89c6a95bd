#include "bespoke/asset/asset_io.h"

#include <algorithm>
#include <fstream>
#include <new>
#include <set>
#include <string>
#include <utility>

#include "bespoke/asset/detail/grid_conversion.h"
#include "bespoke/asset/detail/preview.h"
#include "bespoke/asset/detail/record_json.h"
#include "bespoke/asset/detail/trailer.h"
#include "bespoke/asset/detail/untrusted.h"
#include "bespoke/atomic_file.h"
#include "bespoke/error.h"

namespace bespoke {
namespace {

constexpr std::size_t preview_count = 3;
constexpr std::size_t longest_reason = 200;
constexpr std::size_t longest_path = 80;

/// u_0, u_1, … of the first step, s1_u_0, s1_u_1, … of the second.
std::string level_name(std::size_t step, std::size_t level) {
  return step_prefix(step) + "u_" + std::to_string(level);
}

/// One line of printable characters.
std::string one_line(std::string text, std::size_t longest) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  if (text.size() > longest) text = text.substr(0, longest - 3) + "...";
  return text;
}

std::string name_for_message(const std::filesystem::path& path) {
  const std::string name = path.string();
  return name.size() <= longest_path ? name : "..." + name.substr(name.size() - longest_path + 3);
}

std::string read_bytes(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw FileError(name_for_message(path) + ": no such file");
  if (!std::filesystem::is_regular_file(status))
    throw FileError(name_for_message(path) + ": not a regular file");
  std::ifstream stream(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = stream.tellg();
  if (!stream || size < 0) throw FileError(name_for_message(path) + ": cannot be opened for reading");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  stream.seekg(0);
  if (!stream.read(bytes.data(), size))
    throw FileError(name_for_message(path) + ": cannot be read to its end");
  return bytes;
}

void require(bool holds, const std::string& what) {
  if (!holds) throw FormatError(what);
}

/// The plain entries repeat the record for other programs; where the two differ, programs would disagree
/// about the map.
void require_same_metadata(const Metadata& found, const std::string& record) {
  const Metadata expected = file_metadata(record);
  for (const auto& [key, value] : expected) {
    const auto entry = found.find(key);
    require(entry != found.end(), "metadata " + key + " is missing");
    require(entry->second == value, "metadata " + key + " contradicts the record");
  }
  for (const auto& [key, value] : found) require(expected.count(key) > 0, "unexpected metadata " + key);
}

std::string record_of(const Metadata& metadata) {
  const auto version = metadata.find(version_key);
  require(version != metadata.end(),
          std::string("metadata ") + version_key + " is missing: not a bespoke asset");
  const auto* number = std::get_if<std::int64_t>(&version->second);
  require(number != nullptr, std::string("metadata ") + version_key + " is not a 64-bit integer");
  require(*number == one_step_version || *number == chain_version,
          "format version " + std::to_string(*number) + "; this program reads versions " +
              std::to_string(one_step_version) + " and " + std::to_string(chain_version));
  const auto record = metadata.find(record_key);
  require(record != metadata.end() && std::holds_alternative<std::string>(record->second),
          std::string("metadata ") + record_key + " is missing");
  return std::get<std::string>(record->second);
}

PyramidLevel level_from_grid(StoredGrid grid, const std::string& name, const Vector3& origin,
                             ValuePrecision precision, const LevelRecord& record) {
  require(grid.name == name, "grid " + grid.name + " stands in the place of " + name);
  require(grid.components == 3 && grid.grid_class == GridClass::unknown,
          "grid " + grid.name + " is no Vec3S grid");
  require(grid.voxel_size == record.voxel_size && grid.origin == origin,
          "the transform of grid " + grid.name + " contradicts the record");
  require(grid.leaves.size() == record.leaves,
          "grid " + grid.name + " has " + std::to_string(grid.leaves.size()) + " leaves, the record says " +
              std::to_string(record.leaves));
  require(grid.half == (precision == ValuePrecision::half),
          "the precision of grid " + grid.name + " contradicts the record");
  require(grid.background == 0, "the background of grid " + grid.name + " is not 0");
  require(grid.active.empty(), "grid " + grid.name + " has inactive nodes in its leaves");
  require(grid.metadata.empty(), "grid " + grid.name + " has unexpected metadata");
  return {grid.voxel_size, std::move(grid.leaves), std::move(grid.values)};
}

Asset asset_from(StoredFile file, std::string_view exact_map) {
  const std::string record = record_of(file.metadata);
  ParsedRecord parsed = parse_record(record);
  require_same_metadata(file.metadata, record);
  Asset& asset = parsed.asset;
  std::size_t count = preview_count;
  for (const std::vector<LevelRecord>& levels : parsed.levels) count += levels.size();
  require(file.grids.size() == count, "has " + std::to_string(file.grids.size()) +
                                          " grids, the record asks for " + std::to_string(count));
  std::size_t grid = preview_count;
  for (std::size_t step = 0; step < asset.steps.size(); ++step) {
    Pyramid& pyramid = asset.steps[step].pyramid;
    for (std::size_t level = 0; level < parsed.levels[step].size(); ++level)
      pyramid.levels.push_back(level_from_grid(std::move(file.grids[grid++]), level_name(step, level),
                                               pyramid.origin, pyramid.precision,
                                               parsed.levels[step][level]));
  }
  file.grids.resize(preview_count);
  asset.preview = std::make_shared<PreviewGrids>(std::move(file.grids));
  asset.exact_map = exact_map;
  require_valid(asset);
  return std::move(asset);
}

StoredFile stored_file_from(const Asset& asset) {
  StoredFile file;
  const std::string record = record_json(asset);
  file.metadata = file_metadata(record);
  file.grids = asset.preview->grids();
  for (std::size_t step = 0; step < asset.steps.size(); ++step) {
    const Pyramid& pyramid = asset.steps[step].pyramid;
    for (std::size_t level = 0; level < pyramid.levels.size(); ++level) {
      StoredGrid grid;
      grid.name = level_name(step, level);
      grid.voxel_size = pyramid.levels[level].voxel_size;
      grid.origin = pyramid.origin;
      grid.half = pyramid.precision == ValuePrecision::half;
      grid.leaves = pyramid.levels[level].leaves;
      grid.values = pyramid.levels[level].values;
      file.grids.push_back(std::move(grid));
    }
  }
  return file;
}

}  // namespace

Asset read_asset(const std::filesystem::path& path, const ReadAssetOptions& options) {
  const std::string bytes = read_bytes(path);
  try {
    const AssetSections sections = unseal(bytes);
    return asset_from(
        options.untrusted ? stored_file_from_untrusted_vdb(sections.vdb) : stored_file_from_vdb(sections.vdb),
        sections.exact_map);
  } catch (const FileError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw MemoryLimitError(name_for_message(path) + ": does not fit into memory");
  } catch (const std::exception& error) {
    throw FormatError(name_for_message(path) + ": " + one_line(error.what(), longest_reason));
  }
}

void write_asset(const std::filesystem::path& path, const Asset& asset) {
  require_valid(asset);
  if (!asset.preview) throw InvalidInput("the asset has no preview grids; with_preview adds them");
  const std::string vdb = vdb_bytes(stored_file_from(asset));
  const std::string bytes = seal({vdb, asset.exact_map});
  write_atomically(path, [&](const std::filesystem::path& temporary) {
    std::ofstream stream(temporary, std::ios::binary);
    stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    stream.flush();
    if (!stream) throw FileError(path.string() + ": cannot be written, is the disk full?");
  });
}

}  // namespace bespoke
