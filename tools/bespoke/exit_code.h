#pragma once

#include <functional>

namespace bespoke::command {

/// What the command's exit codes mean; an interruption gives 128 plus the number of the signal.
enum ExitCode : int {
  done = 0,
  wrong_arguments = 1,
  bad_input = 2,
  fit_failed = 3,
  file_or_memory_trouble = 4,
};

/// Runs the body; an exception becomes one line on standard error and its exit code.
int exit_code_of(const std::function<void()>& body);

}  // namespace bespoke::command
