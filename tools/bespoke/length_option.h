#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "bespoke/length.h"

namespace bespoke::command {

/// "0.02" or "10%"; finite and within the range. Throws CLI::ValidationError naming `option` and the text.
Length parse_length(const std::string& option, const std::string& text,
                    LengthRange range = LengthRange::positive);

/// A fraction of the diagonal as the user would write it, for instance "10%".
std::string percentage(double fraction);

/// Adds an option that holds a length; `description` ends with what the default is.
CLI::Option* add_length_option(CLI::App& app, const std::string& name, std::optional<Length>& length,
                               const std::string& description, LengthRange range = LengthRange::positive);

}  // namespace bespoke::command
