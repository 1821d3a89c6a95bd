#pragma once

#include <string>
#include <vector>

#include "bespoke/pattern/pattern_sheet.h"

namespace bespoke {

/// The measures of pieces by size: piece,measure,unit and a column a size. Of a piece its area, width and
/// height (the grain upright), strain, and widths at named lines; of a seam the lengths of its two sides.
/// Sizes have the same pieces, as nested_sheet wants them.
std::string size_table_csv(const std::vector<SizedPattern>& sizes);

}  // namespace bespoke
