#include "bespoke/asset/detail/block_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <istream>

#include "bespoke/error.h"
#include "support/file_text.h"
#include "support/scratch_directory.h"

namespace bespoke {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

class BlockFiles : public testing::Test {
 protected:
  BlockFiles() : content_(5 * block_size + 1000, '\0') {
    for (std::size_t i = 0; i < content_.size(); ++i) content_[i] = static_cast<char>(i * i % 251);
    write(seal({content_, "exact"}, TrailerForm::block_hashes));
  }
  void write(const std::string& bytes) {
    sealed_ = bytes;
    test::write_text(path_, bytes);
  }
  std::string content_, sealed_;
  test::ScratchDirectory directory_;
  std::filesystem::path path_ = directory_ / "file";
};

TEST_F(BlockFiles, AreReadBlockByBlock) {
  std::optional<BlockFile> file = BlockFile::open(path_);
  ASSERT_TRUE(file);
  EXPECT_EQ(file->file_size(), sealed_.size());
  const std::uint64_t before = file->bytes_read();
  EXPECT_EQ(before, trailer_size + 6 * digest_size);
  EXPECT_EQ(file->block(2), content_.substr(2 * block_size, block_size));
  EXPECT_EQ(file->block(5), content_.substr(5 * block_size) + "exact");
  EXPECT_EQ(file->bytes_read(), before + block_size + 1005);
}

TEST_F(BlockFiles, OfOneHashAreNone) {
  write(seal({content_, "exact"}));
  EXPECT_FALSE(BlockFile::open(path_));
}

TEST_F(BlockFiles, GiveAStreamThatSeeksWithoutReading) {
  std::optional<BlockFile> file = BlockFile::open(path_);
  const std::uint64_t before = file->bytes_read();
  BlockBuffer buffer(*file);
  std::istream stream(&buffer);
  for (std::size_t at = 0; at < content_.size(); at += 100) stream.seekg(static_cast<std::streamoff>(at));
  EXPECT_EQ(file->bytes_read(), before);
  std::string bytes(3000, '\0');
  const std::size_t across = 3 * block_size - 1000;
  stream.seekg(static_cast<std::streamoff>(across));
  stream.read(bytes.data(), 3000);
  EXPECT_EQ(bytes, content_.substr(across, 3000));
  stream.seekg(-3000, std::ios::cur);
  stream.seekg(10, std::ios::cur);
  EXPECT_EQ(static_cast<std::size_t>(stream.tellg()), across + 10);
  EXPECT_EQ(static_cast<char>(stream.get()), content_[across + 10]);
  EXPECT_LE(file->bytes_read(), before + 3 * block_size);
}

TEST_F(BlockFiles, GiveAStreamThatEndsWithTheGrids) {
  std::optional<BlockFile> file = BlockFile::open(path_);
  BlockBuffer buffer(*file);
  std::istream stream(&buffer);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(stream), {}), content_);
  stream.clear();
  EXPECT_FALSE(stream.seekg(static_cast<std::streamoff>(content_.size() + 1)));
  stream.clear();
  EXPECT_FALSE(stream.seekg(-1));
}

TEST_F(BlockFiles, HandOutNoDamagedBlock) {
  sealed_[3 * block_size + 5] ^= 1;
  write(sealed_);
  std::optional<BlockFile> file = BlockFile::open(path_);
  EXPECT_NO_THROW(file->block(2));
  EXPECT_THAT([&] { file->block(3); }, ThrowsMessage<FormatError>(HasSubstr("block at byte 196608")));
  BlockBuffer buffer(*file);
  std::istream stream(&buffer);
  stream.exceptions(std::ios::badbit);
  stream.seekg(3 * block_size);
  EXPECT_THROW(stream.get(), FormatError);
}

TEST_F(BlockFiles, ThatAreNoneAreRefused) {
  for (const std::size_t size : {std::size_t{0}, std::size_t{63}, sealed_.size() - 1, sealed_.size() / 2}) {
    test::write_text(path_, sealed_.substr(0, size));
    EXPECT_THROW(BlockFile::open(path_), FormatError) << size;
  }
  EXPECT_THROW(BlockFile::open(directory_ / "absent"), FileError);
}

}  // namespace
}  // namespace bespoke
