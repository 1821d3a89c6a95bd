#pragma once

#include <string>
#include <vector>

#include "bespoke/catalog/map_difference.h"
#include "bespoke/catalog/record_difference.h"

namespace bespoke {

/// Two maps and how they differ, for a report.
struct ComparedMaps {
  const Asset& a;
  const Asset& b;
  MapDifference maps;
  RecordDifference records;
  std::vector<std::string> products;  ///< names, in the order of maps.products
};

/// As lines for a person.
std::string difference_text(const ComparedMaps& compared);

/// The same as a JSON object.
std::string difference_json(const ComparedMaps& compared);

}  // namespace bespoke
