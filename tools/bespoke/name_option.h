#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/enum_names.h"

namespace bespoke::command {

/// Adds an option whose value is one of the names of an enumeration (enum_names.h).
template <class Value, class Table>
CLI::Option* add_name_option(CLI::App& app, const std::string& name, std::optional<Value>& value,
                             const Table& names, const std::string& description) {
  std::vector<std::string> known;
  std::string choices;
  for (const auto& named : names) {
    known.emplace_back(named.name);
    choices += (choices.empty() ? "" : "|") + known.back();
  }
  return app
      .add_option_function<std::string>(
          name, [&value, &names](const std::string& text) { value = value_of(names, text); }, description)
      ->check(CLI::IsMember(known).description(""))
      ->type_name(choices);
}

}  // namespace bespoke::command
