#pragma once

#include <filesystem>

namespace bespoke::command {

/// Whether an output is named "-", which stands for standard output; a file of that name is "./-".
bool is_standard_output(const std::filesystem::path& output);

/// Keeps standard output for the output "-": what is printed from now on goes to standard error. Throws
/// FileError where it is closed.
void reserve_standard_output();

/// What an output is written to: the file itself, or a name of standard output as reserved.
std::filesystem::path output_target(const std::filesystem::path& output);

}  // namespace bespoke::command
