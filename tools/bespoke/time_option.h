#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace bespoke::command {

/// Adds `--t`, the time of the motion: any finite number.
CLI::Option* add_time_option(CLI::App& app, double& t, const std::string& description);

}  // namespace bespoke::command
