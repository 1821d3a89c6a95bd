#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "bespoke/pattern/flat_pattern.h"

namespace bespoke::command {

/// Adds an option of millimetres within a range.
CLI::Option* add_millimetres(CLI::App& app, const std::string& name, double& value, const CLI::Range& range,
                             const std::string& description);

/// Adds --seam-allowance.
void add_seam_allowance(CLI::App& app, double& millimetres);

/// "1.5" sets the tolerance of all seams, "3=20" what seam 3 eases. Throws CLI::ValidationError.
void set_eases(const std::vector<std::string>& texts, PatternOptions& options);

/// The anchors of the source and the ends of its curves, in millimetres; `unit` where the file says none.
/// Throws as read_anchors, and InvalidInput where no unit is known.
std::vector<SurfaceMark> marks_of_anchors(const std::string& path, const std::string& unit);

}  // namespace bespoke::command
