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
void add_flatten_command(CLI::App& app, const PlanHandler& handle_plan);
void add_view_command(CLI::App& app, const PlanHandler& handle_plan);
void add_report_command(CLI::App& app, const PlanHandler& handle_plan);

/// Help of options and arguments that several subcommands have.
inline constexpr const char* half_help =
    "Store 16-bit floats instead of 32-bit ones; error and proof are those of the rounded values";
inline constexpr const char* json_help = "Print one JSON object instead of lines";
inline constexpr const char* map_help = "Map made by `bespoke fit`, .vdb";
inline constexpr const char* page_help =
    "Page to write, .html: one file, which needs no server and no network";
inline constexpr const char* printed_output_help = "Write the result to this file instead of printing it";
inline constexpr const char* untrusted_help = "Check map files in a child process under limits first";

}  // namespace bespoke::command
