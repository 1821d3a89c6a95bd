#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "bespoke/error.h"

namespace bespoke {

/// What a value of an enumeration is called on the command line, in assets and in reports. A table of names
/// is any range of rows with these two members, and stands beside its enumeration.
template <class Value>
struct Named {
  std::string_view name;
  Value value;
};

/// Throws InvalidInput for a value that the table does not hold, so that none is recorded without a name.
template <class Table, class Value>
constexpr std::string_view name_of(const Table& table, Value value) {
  for (const auto& row : table)
    if (row.value == value) return row.name;
  throw InvalidInput("value " + std::to_string(static_cast<int>(value)) + " of an enumeration has no name");
}

/// Empty for a name that the table does not hold.
template <class Table>
constexpr auto value_of(const Table& table, std::string_view name) {
  std::optional<decltype(table.begin()->value)> found;
  for (const auto& row : table)
    if (row.name == name) found = row.value;
  return found;
}

}  // namespace bespoke
