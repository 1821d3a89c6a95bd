#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "bespoke/asset/asset.h"
#include "bespoke/lattice/pyramid_part.h"

namespace bespoke {

/// One step of a map, of whose u a part was read.
struct MapStepPart {
  AffineMap affine;
  PyramidPart pyramid;
};

/// What points in a box need of a map, to carry them. It is no Asset, because what an asset is for besides
/// (certificate, inverse, composition, previews) needs all of it.
struct AssetPart {
  RigidTransform target_from_source;
  RotationPath path = RotationPath::geodesic;
  std::vector<MapStepPart> steps;
  AssetRecord record;
  std::uint64_t bytes_read = 0;
  std::uint64_t file_bytes = 0;
};

/// Whether a part of the file can be read: its trailer has hashes of blocks. False for what is no asset.
bool has_block_hashes(const std::filesystem::path& path);

/// The part of the map for points in `box` (source frame, mesh units) and for where its steps take them.
/// Nothing for a file whose trailer has one hash for all, which must be read as a whole. A block of the file
/// is verified when it is first read, before OpenVDB sees a byte of it; what lies in other blocks is not
/// looked at. Throws as read_asset, InvalidInput for a box that is empty or not finite.
std::optional<AssetPart> read_asset_part(const std::filesystem::path& path, const Box& box);

/// As loaded_chain of the whole, with the same bits; a query of unread values throws OutsidePart.
ElasticChain loaded_chain(std::vector<MapStepPart> steps);

}  // namespace bespoke
