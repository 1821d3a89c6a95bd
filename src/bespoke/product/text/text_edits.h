#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "bespoke/product/text/number_text.h"
#include "bespoke/types.h"

namespace bespoke {

/// A number of a text and what takes its place.
struct NumberEdit {
  NumberText number;
  double value = 0;
  int decimals = 0;
  char point = '.';  ///< before the decimals, or a comma
};

/// Characters of a text and what takes their place.
struct TextEdit {
  std::string_view old;
  std::string text;
};

/// Three numbers that are one position or one direction.
using NumberTriple = std::array<NumberText, 3>;

/// The triples' values, 3×n.
Points values(const std::vector<NumberTriple>& triples);

/// Appends what puts the columns of `moved` (3×n) into the triples' places, with `decimals` or as many as a
/// number has, whichever are more.
void add_edits(const std::vector<NumberTriple>& triples, const Points& moved, int decimals,
               std::vector<NumberEdit>& edits);

/// The text with the edits made, which do not overlap. Numbers that would be read back as they were keep
/// their characters.
std::string edited(std::string_view text, std::vector<NumberEdit> numbers, std::vector<TextEdit> texts = {});

}  // namespace bespoke
