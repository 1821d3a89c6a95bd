#include "bespoke/batch/detail/tar_format.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/stat.h>

#include "support/run_program.h"

namespace bespoke {
namespace {

using ::testing::HasSubstr;

class TarFormat : public ::testing::Test {
 protected:
  /// The bytes as a file, and what a reader finds in it.
  std::vector<TarMember> members(const std::string& archive) {
    test::write_text(directory_ / "a.tar", archive);
    file_ = std::make_unique<RandomAccessFile>(directory_ / "a.tar", RandomAccessFile::Access::read);
    TarReader reader(*file_);
    std::vector<TarMember> members;
    while (std::optional<TarMember> member = reader.next()) members.push_back(*member);
    ended_ = reader.is_ended();
    return members;
  }

  std::string content(const TarMember& member) const { return file_->read(member.content, member.bytes); }

  static std::string member(const std::string& name, const std::string& content) {
    return tar_header(name, content.size(), 1'600'000'000) + content + tar_padding(content.size());
  }

  test::ScratchDirectory directory_;
  std::unique_ptr<RandomAccessFile> file_;
  bool ended_ = false;
};

const std::vector<std::string> names{"a",
                                     "größe/ß.obj",
                                     std::string(100, 'n'),
                                     std::string(101, 'n'),
                                     std::string(90, 'd') + "/" + std::string(200, 'n'),
                                     std::string(200, 'd') + "/" + std::string(200, 'e') + "/n"};
const std::vector<std::size_t> sizes{0, 1, 511, 512, 513, 20000};

TEST_F(TarFormat, IsThatOfTar) {
  std::string archive = tar_comment("a mark");
  for (const std::string& name : names) archive += member(name, name + " has this content");
  for (const std::size_t size : sizes)
    archive += member("of_" + std::to_string(size), std::string(size, 'x'));
  test::write_text(directory_ / "a.tar", archive + tar_comment("another") + tar_end());
  const test::ProgramResult result =
      test::run_program({"tar", "-xf", directory_ / "a.tar", "-C", directory_.path()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  for (const std::string& name : names)
    EXPECT_EQ(test::read_text(directory_ / name), name + " has this content");
  for (const std::size_t size : sizes)
    EXPECT_EQ(test::read_text(directory_ / ("of_" + std::to_string(size))), std::string(size, 'x'));
  struct stat status;
  ASSERT_EQ(::stat((directory_ / "a").c_str(), &status), 0);
  EXPECT_EQ(status.st_mtim.tv_sec, 1'600'000'000);
  EXPECT_EQ(status.st_mtim.tv_nsec, 0);
}

TEST_F(TarFormat, ReadsWhatItWrites) {
  std::string archive = tar_comment("a mark");
  for (const std::string& name : names)
    for (const std::size_t size : sizes) archive += member(name, std::string(size, 'x'));
  const std::string text(100'000, 't');
  archive += tar_comment(text);
  const std::vector<TarMember> found = members(archive + tar_end());
  EXPECT_TRUE(ended_);
  ASSERT_EQ(found.size(), 2 + names.size() * sizes.size());
  EXPECT_EQ(found.front().comment, "a mark");
  EXPECT_EQ(found.back().comment, text);
  std::size_t i = 1;
  for (const std::string& name : names)
    for (const std::size_t size : sizes) {
      EXPECT_EQ(found[i].name, name);
      EXPECT_EQ(content(found[i]), std::string(size, 'x'));
      EXPECT_EQ(found[i].begin, found[i - 1].end);
      EXPECT_EQ(found[i].kind, TarMember::Kind::file);
      ++i;
    }
  EXPECT_EQ(found.back().end, archive.size());
}

TEST_F(TarFormat, ReadsWhatTarWrites) {
  for (const std::string format : {"gnu", "pax", "ustar", "v7"}) {
    const bool is_long = format == "gnu" || format == "pax";
    const std::string name = is_long ? names.back() : "directory/n";
    std::filesystem::create_directories((directory_ / name).parent_path());
    test::write_text(directory_ / name, format);
    const test::ProgramResult made = test::run_program(
        {"tar", "--format=" + format, "-cf", directory_ / "b.tar", "-C", directory_.path(), name});
    ASSERT_EQ(made.exit_code, 0) << made.err;
    const std::vector<TarMember> found = members(test::read_text(directory_ / "b.tar"));
    ASSERT_EQ(found.size(), 1u) << format;
    EXPECT_EQ(found[0].name, name);
    EXPECT_EQ(content(found[0]), format);
  }
}

TEST_F(TarFormat, ReadsTheWholeMembersOfEveryShorterFile) {
  const std::string archive = tar_comment("a mark") + member(names.back(), std::string(700, 'x')) +
                              member("b", std::string(512, 'y')) + tar_end();
  const std::vector<TarMember> all = members(archive);
  ASSERT_EQ(all.size(), 3u);
  for (std::size_t size = 0; size < archive.size(); ++size) {
    const std::vector<TarMember> found = members(archive.substr(0, size));
    const auto whole = std::count_if(all.begin(), all.end(), [&](const auto& m) { return m.end <= size; });
    ASSERT_EQ(static_cast<std::ptrdiff_t>(found.size()), whole) << size;
    ASSERT_FALSE(ended_) << size;
  }
}

TEST_F(TarFormat, StopsAtADamagedHeader) {
  const std::string first = member("a", "A"), second = member("b", "B");
  for (std::size_t place = 0; place < 512; place += 7) {
    std::string damaged = second;
    damaged[place] = static_cast<char>(damaged[place] ^ 0x40);
    const std::vector<TarMember> found = members(first + damaged + tar_end());
    ASSERT_EQ(found.size(), 1u) << place;
    EXPECT_FALSE(ended_);
  }
}

TEST_F(TarFormat, HoldsFilesOfMoreThanEightGigabytes) {
  constexpr std::uint64_t bytes = (std::uint64_t{9} << 30) + 5;
  const std::string header = tar_header("large", bytes, 0), last = member("last", "content") + tar_end();
  const std::uint64_t behind = header.size() + bytes + tar_padding(bytes).size();
  test::write_text(directory_ / "large.tar", header);
  RandomAccessFile file(directory_ / "large.tar", RandomAccessFile::Access::write);
  file.write(behind, last);
  TarReader reader(file);
  EXPECT_EQ(reader.next()->bytes, bytes);
  EXPECT_EQ(reader.next()->name, "last");
  EXPECT_FALSE(reader.next());
  EXPECT_TRUE(reader.is_ended());
  const test::ProgramResult listed = test::run_program({"tar", "-tvf", directory_ / "large.tar"});
  EXPECT_EQ(listed.exit_code, 0) << listed.err;
  EXPECT_THAT(listed.out, HasSubstr(std::to_string(bytes)));
  EXPECT_THAT(listed.out, HasSubstr("last"));
}

}  // namespace
}  // namespace bespoke
