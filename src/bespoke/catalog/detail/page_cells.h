#pragma once

#include <string>
#include <vector>

#include "bespoke/catalog/catalog.h"

namespace bespoke {

/// What a page of maps begins with, up to its heading.
std::string page_head(const std::string& title, const std::string& heading);

/// What a table begins with, up to its first row.
std::string table_head(const std::vector<std::string>& headings);

/// A length or ratio in the digits that a page shows.
std::string number(double value);

/// A cell, text to the right.
std::string number_cell(const std::string& text);

/// Whether a map is certified.
std::string proof_cell(const CatalogEntry& entry);

/// The size of a map's file.
std::string size_cell(const CatalogEntry& entry);

}  // namespace bespoke
