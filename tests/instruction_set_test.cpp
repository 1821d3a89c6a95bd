#include "bespoke/instruction_set.h"

#include <gmock/gmock.h>

#include <Eigen/Core>
#include <set>
#include <vector>

#include "bespoke/error.h"

namespace bespoke {
namespace {

struct Product {
  [[gnu::always_inline]] static void run(const std::vector<double>& a, double b,
                                         std::vector<double>& result) {
    for (const double value : a) result.push_back(value * b);
  }
};

TEST(InstructionSet, IsTheMostThatTheMachineSupportsUntilToldOtherwise) {
  const std::vector<InstructionSet> supported = supported_instruction_sets();
  EXPECT_EQ(supported.front(), InstructionSet::baseline);
  EXPECT_EQ(instruction_set(), supported.back());
  use_instruction_set(InstructionSet::baseline);
  EXPECT_EQ(instruction_set(), InstructionSet::baseline);
  use_instruction_set(supported.back());
}

TEST(InstructionSet, UnsupportedOnesAreRefused) {
  EXPECT_THROW(use_instruction_set(static_cast<InstructionSet>(99)), InvalidInput);
  EXPECT_EQ(instruction_set(), supported_instruction_sets().back());
}

TEST(RunDispatched, RunsTheLoopOnceWithEverySet) {
  for (const InstructionSet set : supported_instruction_sets()) {
    use_instruction_set(set);
    std::vector<double> result;
    run_dispatched<Product>(std::vector<double>{1, 2, 3}, 0.5, result);
    EXPECT_THAT(result, testing::ElementsAre(0.5, 1, 1.5));
  }
}

#if defined(__x86_64__)
// A sum's order, and so its last bits, follows from how Eigen cuts matrix products.
TEST(InstructionSet, MatrixProductsAreCutTheSameWayWhateverTheCaches) {
  EXPECT_EQ(Eigen::l1CacheSize(), 32 << 10);
  EXPECT_EQ(Eigen::l2CacheSize(), 256 << 10);
  EXPECT_EQ(Eigen::l3CacheSize(), 2 << 20);
}

struct OwnAddress {
  [[gnu::always_inline]] static void run(const void*& address) {
    asm volatile("lea 0(%%rip), %0" : "=r"(address));
  }
};

TEST(RunDispatched, HasACopyOfTheLoopForEverySet) {
  std::set<const void*> addresses;
  for (const InstructionSet set : supported_instruction_sets()) {
    use_instruction_set(set);
    const void* address = nullptr;
    run_dispatched<OwnAddress>(address);
    addresses.insert(address);
  }
  EXPECT_EQ(addresses.size(), supported_instruction_sets().size());
}
#endif

}  // namespace
}  // namespace bespoke
