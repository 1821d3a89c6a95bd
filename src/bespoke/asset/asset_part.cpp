#include "bespoke/asset/asset_part.h"

#include <istream>
#include <memory>
#include <utility>

#include "bespoke/asset/detail/block_file.h"
#include "bespoke/asset/detail/record_json.h"
#include "bespoke/asset/detail/stored_asset.h"
#include "bespoke/asset/grids/vdb_part.h"
#include "bespoke/error.h"
#include "bespoke/lattice/part_map.h"

namespace bespoke {
namespace {

struct GridsOfStep {
  std::size_t first;  ///< the grid of level 0
  std::size_t step;
};

/// `outline` knows origin and precision.
PyramidPart read_pyramid(VdbPart& vdb, const GridsOfStep& grids, Pyramid outline,
                         const std::vector<LevelRecord>& records, const Box& box) {
  PyramidPart part{std::move(outline), {}};
  for (std::size_t level = 0; level < records.size(); ++level) {
    const LevelRecord& record = records[level];
    const std::string name = level_name(grids.step, level);
    require_storable(record.voxel_size, "grid " + name);
    StoredGridPart stored =
        vdb.read(grids.first + level, leaves_near({part.read.origin, record.voxel_size}, box));
    require_level(stored.grid, name, part.read, record.voxel_size);
    require_leaf_count(stored.all_leaves.size(), name, record);
    part.read.levels.push_back(
        {record.voxel_size, std::move(stored.grid.leaves), std::move(stored.grid.values)});
    part.leaves.push_back(std::move(stored.all_leaves));
  }
  return part;
}

AssetPart part_from(BlockFile& file, const Box& box) {
  BlockBuffer buffer(file);
  VdbPart vdb(buffer);
  ParsedRecord parsed = parse_record(checked_record(vdb.metadata()));
  require_grid_count(vdb.grid_count(), parsed);
  require_valid(parsed.asset);
  AssetPart part{parsed.asset.target_from_source, parsed.asset.path, {}, std::move(parsed.asset.record)};
  std::size_t grid = preview_count;
  Box asked = box;
  for (std::size_t step = 0; step < parsed.asset.steps.size(); ++step) {
    MapStep& known = parsed.asset.steps[step];
    const std::vector<LevelRecord>& levels = parsed.levels[step];
    part.steps.push_back(
        {known.affine, read_pyramid(vdb, {grid, step}, std::move(known.pyramid), levels, asked)});
    require_valid(part.steps.back().pyramid);
    grid += levels.size();
    asked = image_box(asked, known.affine, part.steps.back().pyramid);
  }
  part.bytes_read = file.bytes_read();
  part.file_bytes = file.file_size();
  return part;
}

}  // namespace

bool has_block_hashes(const std::filesystem::path& path) {
  try {
    return BlockFile::open(path).has_value();
  } catch (const Error&) {
    return false;
  }
}

std::optional<AssetPart> read_asset_part(const std::filesystem::path& path, const Box& box) {
  if (!(!box.isEmpty() && box.min().allFinite() && box.max().allFinite()))
    throw InvalidInput("the box whose part of a map is to be read is empty or not finite");
  try {
    std::optional<BlockFile> file = BlockFile::open(path);
    if (!file) return std::nullopt;
    return part_from(*file, box);
  } catch (...) {
    rethrow_naming(path);
  }
}

ElasticChain loaded_chain(std::vector<MapStepPart> steps) {
  std::vector<std::shared_ptr<const ElasticMap>> maps;
  for (MapStepPart& step : steps)
    maps.push_back(std::make_shared<const PartMap>(step.affine, std::move(step.pyramid)));
  return ElasticChain(std::move(maps));
}

}  // namespace bespoke
