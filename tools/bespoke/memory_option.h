#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>

namespace bespoke::command {

/// Adds `--max-memory`, a number of bytes with a unit.
CLI::Option* add_memory_option(CLI::App& app, std::optional<std::uint64_t>& bytes,
                               const std::string& description);

}  // namespace bespoke::command
