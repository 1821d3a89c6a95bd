#include "bespoke/enum_names.h"

#include <gtest/gtest.h>

#include <array>

namespace bespoke {
namespace {

enum class Fruit { apple, pear, plum };

constexpr std::array fruits{Named<Fruit>{"apple", Fruit::apple}, Named<Fruit>{"pear", Fruit::pear}};

TEST(Named, LeadsFromValueToNameAndBack) {
  for (const auto& row : fruits) {
    EXPECT_EQ(name_of(fruits, row.value), row.name);
    EXPECT_EQ(value_of(fruits, row.name), row.value);
  }
}

TEST(Named, HasNoNameForAValueWithoutARow) {
  EXPECT_THROW(name_of(fruits, Fruit::plum), InvalidInput);
  EXPECT_FALSE(value_of(fruits, "plum"));
  EXPECT_FALSE(value_of(fruits, ""));
}

}  // namespace
}  // namespace bespoke
