#pragma once

#include <string>
#include <string_view>

#include "bespoke/asset/grids/stored_grid.h"

namespace bespoke {

/// The bytes of a .vdb file (Blosc and active-mask compression, seekable) with these grids in this order. The
/// header's UUID, random in OpenVDB, is derived from the content, so that the same content gives the same
/// bytes. Float values come back with the same bits; a half grid's must be of half precision.
std::string vdb_bytes(const StoredFile& file);

/// The grids and metadata of a .vdb file in memory. Refuses grids and metadata of types that an asset does
/// not use, tiles with active values, transforms that are not uniform. Throws FormatError;
/// but OpenVDB may crash on bytes that are not as it wrote them, see read_untrusted.
StoredFile stored_file_from_vdb(std::string_view bytes);

/// Registers OpenVDB's grid types; cheap after the first time. Thread-safe.
void initialize_vdb();

}  // namespace bespoke
