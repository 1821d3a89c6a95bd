#pragma once

#include <filesystem>
#include <string>

#include "bespoke/catalog/catalog.h"

namespace bespoke {

/// Where the catalogue of a directory lies: catalog.json in it.
std::filesystem::path catalog_path(const std::filesystem::path& directory);

/// One JSON object; no times, no directory: the same assets give the same bytes.
std::string catalog_json(const Catalog& catalog);

/// What catalog_json wrote into a file. Throws FileError, or FormatError for anything else; both say how to
/// make it anew.
Catalog read_catalog(const std::filesystem::path& path);

/// The catalogue as one HTML page: a row an asset with its source's picture, and a row a refused file.
std::string catalog_page(const Catalog& catalog);

}  // namespace bespoke
