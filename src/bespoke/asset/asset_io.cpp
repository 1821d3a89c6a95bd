#include "bespoke/asset/asset_io.h"

#include <fstream>
#include <string>
#include <utility>

#include "bespoke/asset/detail/record_json.h"
#include "bespoke/asset/detail/stored_asset.h"
#include "bespoke/asset/detail/trailer.h"
#include "bespoke/asset/detail/untrusted.h"
#include "bespoke/asset/grids/grid_conversion.h"
#include "bespoke/asset/grids/preview.h"
#include "bespoke/atomic_file.h"
#include "bespoke/error.h"

namespace bespoke {
namespace {

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

Asset asset_from(StoredFile file, std::string_view exact_map) {
  ParsedRecord parsed = parse_record(checked_record(file.metadata));
  Asset& asset = parsed.asset;
  require_grid_count(file.grids.size(), parsed);
  std::size_t next = preview_count;
  for (std::size_t step = 0; step < asset.steps.size(); ++step) {
    Pyramid& pyramid = asset.steps[step].pyramid;
    for (std::size_t level = 0; level < parsed.levels[step].size(); ++level) {
      const LevelRecord& record = parsed.levels[step][level];
      StoredGrid& grid = file.grids[next++];
      require_level(grid, level_name(step, level), pyramid, record.voxel_size);
      require_leaf_count(grid.leaves.size(), grid.name, record);
      pyramid.levels.push_back({grid.voxel_size, std::move(grid.leaves), std::move(grid.values)});
    }
  }
  file.grids.erase(file.grids.begin() + preview_count,
                   file.grids.begin() + static_cast<std::ptrdiff_t>(next));
  asset.preview = std::make_shared<PreviewGrids>(std::move(file.grids));
  asset.exact_map = exact_map;
  require_valid(asset);
  return std::move(asset);
}

StoredFile stored_file_from(const Asset& asset) {
  StoredFile file;
  const std::string record = record_json(asset);
  file.metadata = file_metadata(record);
  const std::vector<StoredGrid>& previews = asset.preview->grids();
  file.grids.assign(previews.begin(), previews.begin() + preview_count);
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
  // After the levels, so that these keep their places.
  file.grids.insert(file.grids.end(), previews.begin() + preview_count, previews.end());
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
  } catch (...) {
    rethrow_naming(path);
  }
}

void write_asset(const std::filesystem::path& path, const Asset& asset) {
  require_valid(asset);
  if (!asset.preview) throw InvalidInput("the asset has no preview grids; with_preview adds them");
  const std::string vdb = vdb_bytes(stored_file_from(asset));
  const std::string bytes = seal({vdb, asset.exact_map}, form_for(vdb.size() + asset.exact_map.size()));
  write_atomically(path, [&](const std::filesystem::path& temporary) {
    std::ofstream stream(temporary, std::ios::binary);
    stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    stream.flush();
    if (!stream) throw FileError(path.string() + ": cannot be written, is the disk full?");
  });
}

}  // namespace bespoke
