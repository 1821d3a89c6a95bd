#pragma once

#include <CLI/CLI.hpp>
#include <functional>

#include "bespoke/progress.h"

namespace bespoke::command {

/// Options that every long-running subcommand has.
struct RunOptions {
  int threads = 0;  ///< 0 = as many as the machine has
  bool quiet = false;
};

void add_run_options(CLI::App& app, RunOptions& options);

/// Runs the body on the wanted number of threads, with progress on standard error.
void run_with(const RunOptions& options, const std::function<void(const Progress&)>& body);

}  // namespace bespoke::command
