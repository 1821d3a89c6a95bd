#pragma once

#include <string>
#include <string_view>

#include "bespoke/asset/asset.h"
#include "bespoke/asset/grids/stored_grid.h"

namespace bespoke {

/// Everything of an asset but the grids' values and the exact map, as one JSON object; of the pyramids their
/// origins, voxel sizes and numbers of leaves. One step stands in the object itself, several in an array.
/// Doubles are written so that they come back with the same bits; times are left out. Throws InvalidInput
/// where options_json or stages_json is not JSON.
std::string record_json(const Asset& asset);

/// The pyramid's levels as the record names them.
struct LevelRecord {
  double voxel_size = 0;  ///< mesh units
  std::size_t leaves = 0;
};

struct ParsedRecord {
  Asset asset;                                   ///< without pyramid levels, preview and exact map
  std::vector<std::vector<LevelRecord>> levels;  ///< of every step
};

/// Throws FormatError, naming what is missing or wrong.
ParsedRecord parse_record(std::string_view json);

/// The file's metadata: the record's main values as plain entries for other programs, and the record itself
/// under "bespoke:record". A function of the JSON alone, so that a reader can compare.
Metadata file_metadata(const std::string& json);

/// The part of `file_metadata` that the reader needs first.
inline constexpr const char* record_key = "bespoke:record";
inline constexpr const char* version_key = "bespoke:format_version";
inline constexpr std::int64_t one_step_version = 1;
inline constexpr std::int64_t chain_version = 2;

/// What the names of a step's grids and entries begin with: nothing for the first, "s1_" for the second.
std::string step_prefix(std::size_t step);

}  // namespace bespoke
