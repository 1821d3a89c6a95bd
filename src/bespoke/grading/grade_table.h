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
  double source = 0;            ///< on the source
  double carried = 0;           ///< on the source as the map takes it to the size
  std::optional<double> model;  ///< on the size's own model (length_on), where there is one
};

struct GradedSize {
  std::string name;
  std::vector<GradedMeasure> measures;  ///< the same ones in every size
};

struct GradedSeries {
  std::string unit;  ///< empty: not known
  int decimals = 2;  ///< of lengths in Markdown
  std::vector<GradedSize> sizes;
};

/// The lines of the source as the map takes them at time t. `model`: the size's own, or null.
std::vector<GradedMeasure> graded_measures(const std::vector<MeasureLine>& lines, const OpenedMap& map,
                                           double t, const SizeModel* model);

/// As many as show a ten-thousandth of the diagonal (mesh units): 0.1 mm on a body.
int length_decimals(double diagonal);

/// measure,source,model,carried: a line a measure; a cell without a number is empty.
std::string size_csv(const GradedSize& size);

/// The same with the change from source to carried, for a person, under the size's name.
std::string size_markdown(const GradedSeries& series, const GradedSize& size);

/// measure,on,source and a column a size: a line a measure on the models, where every size has its own, and
/// one carried.
std::string series_csv(const GradedSeries& series);

/// The lengths on the models, or else, and said so, the carried ones.
std::string series_markdown(const GradedSeries& series);

}  // namespace bespoke
