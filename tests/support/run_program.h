#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "support/file_text.h"
#include "support/scratch_directory.h"

namespace bespoke::test {

struct ProgramResult {
  int exit_code = 0;  ///< 128 plus the signal when one ended the program
  std::string out;
  std::string err;
};

/// A program that runs with empty standard input and both outputs captured in files.
class RunningProgram {
 public:
  /// `arguments[0]` is the program, looked up in PATH unless it holds a slash.
  explicit RunningProgram(const std::vector<std::string>& arguments);
  /// Returns once standard error holds `text`; false when the program ended, or a minute passed, without.
  bool wait_for_error_text(const std::string& text);
  void send(int signal);
  ProgramResult wait();

 private:
  bool has_ended();

  ScratchDirectory directory_;
  pid_t process_ = 0;
  int status_ = 0;
  bool ended_ = false;
};

/// Throws std::runtime_error where there is no such program.
ProgramResult run_program(const std::vector<std::string>& arguments);

/// Whether PATH has such a program.
bool is_installed(const std::string& program);

}  // namespace bespoke::test
