#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace bespoke::command {

/// " (did you mean NAME?)" for the name that a mistyped word begins, or that takes the fewest letters
/// inserted, left out, changed or swapped (optimal string alignment); empty where none is close.
std::string suggestion(const std::string& word, const std::vector<std::string>& names);

/// The long names of a command's options, with their dashes.
std::vector<std::string> option_names(const CLI::App& command);

/// Refuses a first word that is no subcommand, and so on down to the last one. Throws CLI::ParseError.
void require_known_subcommands(const CLI::App& app, const std::vector<std::string>& words);

/// What a parser's error means: the option that the command does not know, where there is one, since all else
/// may follow from it.
std::string explanation(const CLI::App& command, const CLI::ParseError& error);

}  // namespace bespoke::command
