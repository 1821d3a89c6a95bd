#pragma once

#include <CLI/CLI.hpp>

#include "planned_run.h"

namespace bespoke::command {

/// Each adds one subcommand, which runs while the arguments are parsed.
void add_batch_command(CLI::App& app);
void add_grade_command(CLI::App& app);
void add_catalog_command(CLI::App& app);
void add_info_command(CLI::App& app);
void add_samples_command(CLI::App& app);
void add_pick_command(CLI::App& app);
void add_anchors_command(CLI::App& app);

/// Each adds one subcommand that can be a job of a batch: while the arguments are parsed, its run is planned
/// and taken. May parse again after that, but not after an error.
void add_fit_command(CLI::App& app, const PlanHandler& handle_plan);
void add_apply_command(CLI::App& app, const PlanHandler& handle_plan);
void add_check_command(CLI::App& app, const PlanHandler& handle_plan);
void add_invert_command(CLI::App& app, const PlanHandler& handle_plan);
void add_compose_command(CLI::App& app, const PlanHandler& handle_plan);
void add_measure_command(CLI::App& app, const PlanHandler& handle_plan);
void add_diff_command(CLI::App& app, const PlanHandler& handle_plan);
void add_export_command(CLI::App& app, const PlanHandler& handle_plan);
void add_view_command(CLI::App& app, const PlanHandler& handle_plan);
void add_report_command(CLI::App& app, const PlanHandler& handle_plan);

/// Help of --half, wherever a map is baked.
inline constexpr const char* half_help =
    "Store 16-bit floats instead of 32-bit ones; error and certificate are of the rounded values";

}  // namespace bespoke::command
