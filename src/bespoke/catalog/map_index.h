#pragma once

#include <string>
#include <vector>

#include "bespoke/catalog/catalog.h"

namespace bespoke {

/// A row of an index of pages: a map, or a size on its way. Files as seen from the index, with slashes.
struct MapIndexRow {
  std::string name;
  double t = 1;  ///< how far the map goes
  CatalogEntry map;
  std::string page;                   ///< that shows the map
  std::string picture;                ///< PNG: what comes out
  std::vector<std::string> products;  ///< that are carried, by their files' names
};

/// The index as one HTML page: a row each, with its picture, which leads to the page, and the map's error and
/// certificate beside it; below, by name, what could not be made.
std::string map_index(const std::vector<MapIndexRow>& rows, const std::vector<std::string>& missing);

}  // namespace bespoke
