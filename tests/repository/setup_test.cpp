#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "support/file_text.h"
#include "support/run_program.h"

namespace bespoke {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::Not;

const std::string setup = BESPOKE_SOURCE_DIR "/tools/setup";
const std::vector<std::string> everything = {"--pages",   "--tests",   "--figures", "--viewers",
                                             "--cluster", "--package", "--fuzz",    "--docs"};

test::ProgramResult run_setup(std::vector<std::string> options) {
  options.insert(options.begin(), setup);
  return test::run_program(options);
}

// Packages that exclude each other are refused by apt.
TEST(Setup, WhatItInstallsCanBeHadTogether) {
  if (test::run_program({"sh", "-c", "ls /var/lib/apt/lists/*_Packages*"}).exit_code != 0)
    GTEST_SKIP() << "apt has no lists of packages here: apt-get update";
  std::vector<std::string> options = everything;
  options.push_back("--dry-run");
  const test::ProgramResult all = run_setup(options);
  EXPECT_EQ(all.exit_code, 0) << all.out << all.err;
}

std::vector<std::string> packages_of(std::vector<std::string> options) {
  options.push_back("--list");
  std::istringstream lines(run_setup(options).out);
  return {std::istream_iterator<std::string>(lines), {}};
}

// tools/demo runs it without options: what tests, pages and formatting need is not in that.
TEST(Setup, InstallsForTheCommandWhatBuildingItTakes) {
  const std::vector<std::string> command = packages_of({}), all = packages_of({"--tests"});
  EXPECT_THAT(command, IsSupersetOf({"g++", "cmake", "libopenvdb-dev", "libcli11-dev"}));
  for (const char* other : {"clang-format-14", "libgtest-dev", "python3-pytest", "npm", "chromium"})
    EXPECT_THAT(command, Not(Contains(other)));
  EXPECT_THAT(all, IsSupersetOf(command));
  EXPECT_THAT(all, IsSupersetOf({"clang-format-14", "libgtest-dev", "python3-pytest"}));
}

// The line of apt-get on the front page.
TEST(Setup, FrontPageNamesTheSamePackages) {
  const std::string page = test::read_text(BESPOKE_SOURCE_DIR "/README.md");
  const std::size_t begin = page.find("apt-get install "), end = page.find("\ncmake ", begin);
  ASSERT_LT(end, page.size());
  std::istringstream words(page.substr(begin, end - begin));
  const std::vector<std::string> line{std::istream_iterator<std::string>(words), {}};
  EXPECT_THAT(line, IsSupersetOf(packages_of({})));
}

TEST(Setup, RefusesWhatItDoesNotKnow) {
  const test::ProgramResult result = run_setup({"--viewers", "--slicer"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("--slicer"));
}

}  // namespace
}  // namespace bespoke
