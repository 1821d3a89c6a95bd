#pragma once

#include <string>
#include <string_view>

namespace bespoke {

/// A number of a record that splitting edges copies or makes.
struct SplitNumber {
  double value = 0;       ///< NaN for a word that is no finite number
  int decimals = 0;       ///< of a text
  std::string_view word;  ///< in the file's text, which stands as it is; empty for a new number
};

SplitNumber split_number(std::string_view word);

/// The mean; of whole numbers the nearest one.
SplitNumber middle_number(const SplitNumber& a, const SplitNumber& b, bool is_whole);

/// Appends the number as a text has it.
void append_number(std::string& to, const SplitNumber& number, bool is_whole);

}  // namespace bespoke
