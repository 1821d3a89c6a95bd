#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "bespoke/asset/asset.h"
#include "bespoke/asset/asset_io.h"
#include "bespoke/progress.h"

namespace bespoke {

/// What a catalogue says of an asset. Lengths in the asset's unit.
struct CatalogEntry {
  std::string file;    ///< as seen from the catalogue's directory, with slashes
  std::string sha256;  ///< of the file
  std::size_t bytes = 0;
  std::string unit;
  ModelRecord source;
  ModelRecord target;
  std::string surface_fit;
  std::string elastic;
  double lambda = 0;
  double tolerance = 0;
  double error_p99 = 0;
  double error_max = 0;
  bool bijection = false;
  double min_determinant = 0;
  std::size_t undecided = 0;
  std::size_t folded = 0;
  std::size_t steps = 0;
  std::size_t voxels = 0;
  std::size_t anchors = 0;
  std::string thumbnail;  ///< of the source: a PNG as a data URI
};

/// A file that ends in .vdb and is no sound asset.
struct RefusedFile {
  std::string file;
  std::string reason;
};

struct Catalog {
  std::vector<CatalogEntry> assets;  ///< by file
  std::vector<RefusedFile> refused;  ///< by file
  std::vector<std::string> others;   ///< OpenVDB files that were never assets, for instance images
};

/// What a catalogue says of one asset, without its `file` and thumbnail. Throws as read_asset.
CatalogEntry catalog_entry(const std::filesystem::path& path, const ReadAssetOptions& options = {});

/// Reads and verifies every .vdb file in a directory and below, several at a time; hidden ones are left out.
/// A function of the files alone. Throws FileError when there is no such directory, Interrupted.
Catalog index_assets(const std::filesystem::path& directory, const ReadAssetOptions& options = {},
                     const Progress& progress = {});

}  // namespace bespoke
