#include "bespoke/asset/detail/trailer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "bespoke/sha256.h"

namespace bespoke {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

class Trailers : public testing::TestWithParam<TrailerForm> {
 protected:
  std::string sealed_ = seal({"the grids", "the exact map"}, GetParam());
};

INSTANTIATE_TEST_SUITE_P(OfBothForms, Trailers,
                         testing::Values(TrailerForm::one_hash, TrailerForm::block_hashes));

TEST_P(Trailers, GiveBackBothSections) {
  const std::size_t table = GetParam() == TrailerForm::one_hash ? 0 : digest_size;
  EXPECT_EQ(sealed_.size(), 9 + 13 + table + trailer_size);
  const AssetSections sections = unseal(sealed_);
  EXPECT_EQ(sections.vdb, "the grids");
  EXPECT_EQ(sections.exact_map, "the exact map");
}

TEST_P(Trailers, NoticeEveryFlippedBit) {
  for (std::size_t bit = 0; bit < 8 * sealed_.size(); ++bit) {
    std::string flipped = sealed_;
    flipped[bit / 8] ^= static_cast<char>(1 << bit % 8);
    EXPECT_THROW(unseal(flipped), FormatError) << "bit " << bit;
  }
}

TEST_P(Trailers, NoticeEveryTruncation) {
  for (std::size_t size = 0; size < sealed_.size(); ++size)
    EXPECT_THROW(unseal(sealed_.substr(0, size)), FormatError);
  EXPECT_THROW(unseal(sealed_ + "x"), FormatError);
}

// Readers of form 1 look at the magic number and then at the version, and name one that they do not know.
TEST_P(Trailers, SayTheirVersionWhereEveryReaderLooks) {
  const std::string last = sealed_.substr(sealed_.size() - trailer_size);
  EXPECT_EQ(last.substr(0, 8), "BESPOKE\n");
  EXPECT_EQ(last.substr(8, 4), std::string({static_cast<char>(GetParam()), 0, 0, 0}));
}

TEST_P(Trailers, OfAnUnknownVersionAreRefusedByName) {
  sealed_[sealed_.size() - trailer_size + 8] = 3;
  EXPECT_THAT(
      [&] { unseal(sealed_); },
      ThrowsMessage<FormatError>(HasSubstr("trailer version 3; this program reads versions 1 and 2")));
}

class BlockHashes : public testing::Test {
 protected:
  BlockHashes() : content_(2 * block_size + 1000, '\0') {
    for (std::size_t i = 0; i < content_.size(); ++i) content_[i] = static_cast<char>(i * i % 251);
    sealed_ = seal({content_, "exact"}, TrailerForm::block_hashes);
  }
  /// With the trailer's hash made to fit what is before it.
  std::string signed_again(std::string bytes) const {
    const std::size_t table = content_.size() + 5, digest = bytes.size() - digest_size;
    const std::string hash = sha256(bytes.data() + table, digest - table);
    for (std::size_t i = 0; i < digest_size; ++i)
      bytes[digest + i] = static_cast<char>(std::stoi(hash.substr(2 * i, 2), nullptr, 16));
    return bytes;
  }
  std::string content_, sealed_;
};

TEST_F(BlockHashes, TellWhichBlockIsDamaged) {
  for (std::size_t block = 0; block < 3; ++block) {
    std::string damaged = sealed_;
    damaged[block * block_size + 17] ^= 1;
    damaged[2 * block_size + 900] ^= 1;  // of several the first
    EXPECT_THAT([&] { unseal(damaged); },
                ThrowsMessage<FormatError>(HasSubstr("block at byte " + std::to_string(block * block_size))));
  }
}

TEST_F(BlockHashes, ThatLieAreFoundOut) {
  std::string lying = sealed_;
  lying[content_.size() + 5 + digest_size] ^= 1;
  EXPECT_THAT([&] { unseal(lying); }, ThrowsMessage<FormatError>(HasSubstr("of the blocks' hashes")));
  EXPECT_EQ(unseal(signed_again(sealed_)).vdb, content_);
  EXPECT_THAT([&] { unseal(signed_again(lying)); },
              ThrowsMessage<FormatError>(HasSubstr("block at byte 65536")));
}

TEST_F(BlockHashes, OfOtherSizesThanAreUsedAreRefused) {
  const std::size_t at = sealed_.size() - trailer_size + 12;
  for (const int bits : {0, 9, 27}) {
    std::string other = sealed_;
    for (int i = 0; i < 4; ++i) other[at + static_cast<std::size_t>(i)] = 0;
    if (bits > 0) other[at + static_cast<std::size_t>(bits / 8)] = static_cast<char>(1 << bits % 8);
    EXPECT_THROW(unseal(signed_again(other)), FormatError) << bits;
  }
}

}  // namespace
}  // namespace bespoke
