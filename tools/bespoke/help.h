#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <set>
#include <string>

namespace bespoke::command {

/// Groups of options, in their order in the help.
inline constexpr const char* input_group = "Input";
inline constexpr const char* output_group = "Output";
inline constexpr const char* quality_group = "Quality";
inline constexpr const char* method_group = "Method";
inline constexpr const char* jobs_group = "Many jobs";

/// What is added to `app` from here on, options and arguments, stands in this group.
void begin_group(CLI::App& app, const char* group);

/// Help in groups, at most 80 columns wide. Subcommands that are added later inherit it.
void set_grouped_help(CLI::App& app);

/// `-h` shows the arguments, these options (by their long names) and how to see all; `--help` shows all.
void set_short_help(CLI::App& app, const std::set<std::string>& frequent);

}  // namespace bespoke::command
