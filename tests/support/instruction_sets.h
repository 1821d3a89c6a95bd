#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "bespoke/instruction_set.h"

namespace bespoke::test {

/// Calls result(), numbers out of a dispatched loop, with every instruction set that the machine supports:
/// they must be those of the first, bit for bit.
template <class Result>
void expect_same_bits_with_every_instruction_set(const Result& result) {
  const InstructionSet before = instruction_set();
  use_instruction_set(InstructionSet::baseline);
  const std::vector<double> expected = result();
  ASSERT_FALSE(expected.empty());
  for (const InstructionSet set : supported_instruction_sets()) {
    use_instruction_set(set);
    const std::vector<double> found = result();
    ASSERT_EQ(found.size(), expected.size());
    EXPECT_EQ(std::memcmp(found.data(), expected.data(), found.size() * sizeof(double)), 0)
        << "instruction set " << static_cast<int>(set);
  }
  use_instruction_set(before);
}

}  // namespace bespoke::test
