#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "bespoke/batch/batch_job.h"
#include "grade_sizes.h"

namespace bespoke::command {

/// Which products are flattened in every size, and how.
struct PatternRequest {
  std::vector<std::string> products;
  std::string unit;
  std::string seams;
  bool auto_cut = false;
  double seam_allowance = 0;  ///< millimetres
};

void add_pattern_options(CLI::App& grade, PatternRequest& request);

/// The jobs that write NAME_pattern.svg, .dxf and .csv into the directory: the pieces of all sizes, cut where
/// those of the source's product are. Throws CLI::ValidationError for a product that is not carried.
std::vector<BatchJob> pattern_jobs(const GradeRequest& request, const std::vector<GradeSize>& sizes,
                                   const PatternRequest& patterns);

}  // namespace bespoke::command
