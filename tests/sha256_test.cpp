#include "bespoke/sha256.h"

#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "support/file_text.h"
#include "support/scratch_directory.h"

namespace bespoke {
namespace {

// FIPS 180-4 examples.
TEST(Sha256, OfTheStandardsExamples) {
  EXPECT_EQ(sha256("", 0), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc", 3), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Sha256, OfPiecesIsThatOfTheWhole) {
  Sha256 hash;
  hash.update("a", 1);
  hash.update("", 0);
  hash.update("bc", 2);
  EXPECT_EQ(hash.finish(), sha256("abc", 3));
}

TEST(Sha256, OfAFileIsThatOfItsBytes) {
  const test::ScratchDirectory directory;
  const std::string bytes(1'000'000, 'x');
  test::write_text(directory / "large", bytes);
  test::write_text(directory / "empty", "");
  EXPECT_EQ(sha256_of_file(directory / "large"), sha256(bytes.data(), bytes.size()));
  EXPECT_EQ(sha256_of_file(directory / "empty"), sha256("", 0));
  EXPECT_THROW(sha256_of_file(directory / "absent"), FileError);
  EXPECT_THROW(sha256_of_file(directory.path()), FileError);
}

TEST(Sha256, StartsAnewAfterFinish) {
  Sha256 hash;
  hash.update("x", 1);
  hash.finish();
  hash.update("abc", 3);
  EXPECT_EQ(hash.finish(), sha256("abc", 3));
}

}  // namespace
}  // namespace bespoke
