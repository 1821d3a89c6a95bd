#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "bespoke/pipeline/open_map.h"

namespace bespoke {

/// A map of which a part was read.
struct OpenedPart {
  OpenedMap map;
  std::uint64_t bytes_read = 0;
  std::uint64_t file_bytes = 0;
};

/// Whether the file lets parts of it be read. False for what is no map, which open_map refuses by name.
bool can_open_part(const std::filesystem::path& path);

/// open_map with MapForm::grids, for points in `box` (source frame, mesh units): of those the same bits;
/// a query of unread values throws OutsidePart. Nothing for a file that must be read as a whole.
/// Throws as read_asset_part.
std::optional<OpenedPart> open_map_part(const std::filesystem::path& path, const Box& box);

}  // namespace bespoke
