#pragma once

#include <string>
#include <vector>

namespace bespoke::command {

/// Throws FileError, saying what is missing, in a build without pages: before any work is done.
void require_pages();

/// Whether pages can be written.
bool has_pages();

/// The page with the scene in it.
std::string whole_page(const std::string& scene);

/// A command for a person to type: words with other letters than those of names and numbers stand in quotes.
std::string command_text(const std::vector<std::string>& arguments);

/// The command as it was typed.
std::string typed_command();

/// Remembers the arguments of main.
void remember_arguments(int argc, const char* const* argv);

}  // namespace bespoke::command
