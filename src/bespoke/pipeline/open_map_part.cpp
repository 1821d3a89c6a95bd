#include "bespoke/pipeline/open_map_part.h"

#include <memory>
#include <utility>

#include "bespoke/asset/asset_part.h"

namespace bespoke {

bool can_open_part(const std::filesystem::path& path) { return has_block_hashes(path); }

std::optional<OpenedPart> open_map_part(const std::filesystem::path& path, const Box& box) {
  std::optional<AssetPart> part = read_asset_part(path, box);
  if (!part) return std::nullopt;
  OpenedMap map{std::make_shared<ElasticChain>(loaded_chain(std::move(part->steps))),
                part->target_from_source,
                part->path,
                part->record.source.box.diagonal().norm(),
                part->record.source.hash,
                part->record.target.hash,
                part->record.unit,
                part->record.source.box};
  return OpenedPart{std::move(map), part->bytes_read, part->file_bytes};
}

}  // namespace bespoke
