#pragma once

#include <openvdb/openvdb.h>

#include <string>

#include "bespoke/asset/grids/stored_grid.h"

namespace bespoke {

/// A grid of OpenVDB's as plain data. Throws FormatError for all that an asset does not use.
StoredGrid from_vdb(const openvdb::GridBase& grid);

/// Metadata of OpenVDB's as plain data. Throws FormatError for types that an asset does not use.
MetadataValue from_vdb(const std::string& key, const openvdb::Metadata& metadata);
Metadata from_vdb(const openvdb::MetaMap& map);

}  // namespace bespoke
