#pragma once

#include <string>

namespace bespoke::command {

/// Throws FileError, saying what is missing, in a build without pages: before any work is done.
void require_pages();

/// The page with the scene in it.
std::string whole_page(const std::string& scene);

/// The command as it was typed, for a person to type again: words with other letters than those of names and
/// numbers stand in quotes.
std::string typed_command();

/// Remembers the arguments of main.
void remember_arguments(int argc, const char* const* argv);

}  // namespace bespoke::command
