#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "bespoke/asset/detail/record_json.h"
#include "bespoke/asset/grids/stored_grid.h"

namespace bespoke {

/// What a file must hold to be an asset, for the readers of the whole and of a part. The checks throw
/// FormatError saying what is wrong, without the file's name.

/// Grids before the first level's: those of PreviewGrids.
inline constexpr std::size_t preview_count = 3;

/// Grids that may follow the last level's: target_distance, then source_side.
inline constexpr std::size_t distance_count = 2;

/// u_0, u_1, … of the first step, s1_u_0, s1_u_1, … of the second.
std::string level_name(std::size_t step, std::size_t level);

/// The record, once the version is one of ours and the plain entries repeat it.
std::string checked_record(const Metadata& metadata);

/// The file has as many grids as the record requires, and no more than may follow them.
void require_grid_count(std::size_t grids, const ParsedRecord& record);

/// The grid may stand for a level of the pyramid, of which origin and precision are known: all but its number
/// of leaves.
void require_level(const StoredGrid& grid, const std::string& name, const Pyramid& pyramid,
                   double voxel_size);
void require_leaf_count(std::size_t leaves, const std::string& name, const LevelRecord& record);

/// A path of no more than a line.
std::string name_for_message(const std::filesystem::path& path);

/// In a handler: throws the exception at hand again, with the file's name. FileError stays as it is, want of
/// memory becomes MemoryLimitError, and all else FormatError, in one line of printable characters.
[[noreturn]] void rethrow_naming(const std::filesystem::path& path);

}  // namespace bespoke
