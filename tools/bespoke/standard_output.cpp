#include "standard_output.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <string>

#include "bespoke/error.h"

namespace bespoke::command {
namespace {

/// Of what standard output was when it was reserved.
int reserved_descriptor() {
  static const int descriptor = [] {
    std::fflush(stdout);
    std::cout.flush();
    const int reserved = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    if (reserved < 0 || ::dup2(STDERR_FILENO, STDOUT_FILENO) < 0)
      throw FileError(std::string("-: standard output cannot be written: ") + std::strerror(errno));
    return reserved;
  }();
  return descriptor;
}

}  // namespace

bool is_standard_output(const std::filesystem::path& output) { return output == "-"; }

void reserve_standard_output() { reserved_descriptor(); }

std::filesystem::path output_target(const std::filesystem::path& output) {
  return is_standard_output(output) ? "/dev/fd/" + std::to_string(reserved_descriptor()) : output.string();
}

}  // namespace bespoke::command
