#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bespoke/grading/measures.h"
#include "bespoke/pipeline/open_map.h"

namespace bespoke {

/// One measure in one size, mesh units.
struct GradedMeasure {
  std::string name;
  double source = 0;   ///< on the source
  double carried = 0;  ///< on the source as the map takes it to the size
  /// Of girths, on the size's own model, in the plane nearest to the carried line; empty of other lines and
  /// between two sizes.
  std::optional<double> target;
};

/// The lines of the source as the map takes them, at time t. `target`: the size's model, or nothing.
std::vector<GradedMeasure> grade(const std::vector<MeasureLine>& lines, const OpenedMap& map, double t,
                                 const TriangleMesh* target);

/// measure,source,carried,target: a line a measure, lengths with five digits after the point; a cell without
/// a number is empty.
std::string grade_csv(const std::vector<GradedMeasure>& measures);

/// The same as a table in Markdown under the size's name, with the change against the source.
std::string grade_markdown(const std::string& size, const std::string& unit,
                           const std::vector<GradedMeasure>& measures);

}  // namespace bespoke
