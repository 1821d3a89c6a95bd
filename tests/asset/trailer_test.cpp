#include "bespoke/asset/detail/trailer.h"

#include <gtest/gtest.h>

#include "bespoke/error.h"

namespace bespoke {
namespace {

TEST(Trailer, GivesBackBothSections) {
  const std::string sealed = seal({"the grids", "the exact map"});
  EXPECT_EQ(sealed.size(), 9 + 13 + trailer_size);
  const AssetSections sections = unseal(sealed);
  EXPECT_EQ(sections.vdb, "the grids");
  EXPECT_EQ(sections.exact_map, "the exact map");
}

TEST(Trailer, NoticesEveryFlippedBit) {
  const std::string sealed = seal({"the grids", "the exact map"});
  for (std::size_t bit = 0; bit < 8 * sealed.size(); ++bit) {
    std::string flipped = sealed;
    flipped[bit / 8] ^= static_cast<char>(1 << bit % 8);
    EXPECT_THROW(unseal(flipped), FormatError) << "bit " << bit;
  }
}

TEST(Trailer, NoticesEveryTruncation) {
  const std::string sealed = seal({"the grids", "the exact map"});
  for (std::size_t size = 0; size < sealed.size(); ++size)
    EXPECT_THROW(unseal(sealed.substr(0, size)), FormatError);
  EXPECT_THROW(unseal(sealed + "x"), FormatError);
}

}  // namespace
}  // namespace bespoke
