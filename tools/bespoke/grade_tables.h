#pragma once

#include <filesystem>
#include <vector>

#include "bespoke/batch/batch_job.h"
#include "bespoke/batch/opened_maps.h"
#include "bespoke/grading/measures.h"
#include "grade_sizes.h"

namespace bespoke::command {

/// The girths and lengths of a series: what its tables are made of besides the maps.
struct MeasuringSheet {
  std::filesystem::path measures;
  std::string unit;
  int decimals = 2;
  std::vector<std::vector<MeasureLine>> lines;  ///< on the source, of each size
};

/// Draws the measures on the source, so that what is wrong with them is known before anything runs; a fault
/// of one size joins its faults. Throws for the sheet and the source.
MeasuringSheet plan_measures(const GradeRequest& request, const std::filesystem::path& measures,
                             GradeSizes& sizes);

/// The jobs that write measures.csv and .md: one a size, into its folder, and one that puts theirs side by
/// side. `maps` must outlive them.
std::vector<BatchJob> table_jobs(const GradeRequest& request, const std::vector<GradeSize>& sizes,
                                 const MeasuringSheet& sheet, OpenedMaps& maps);

}  // namespace bespoke::command
