#pragma once

#include <string>

#include "bespoke/error.h"

namespace bespoke::test {

/// What the error says that `action` throws; "accepted" when it throws none of this kind.
template <class ExpectedError, class Action>
std::string error_message(const Action& action) {
  try {
    action();
  } catch (const ExpectedError& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace bespoke::test
