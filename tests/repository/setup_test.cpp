#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "support/run_program.h"

namespace bespoke {
namespace {

using ::testing::HasSubstr;

const std::string setup = BESPOKE_SOURCE_DIR "/tools/setup";
const std::vector<std::string> everything = {"--figures", "--viewers", "--cluster", "--package", "--docs"};

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

TEST(Setup, RefusesWhatItDoesNotKnow) {
  const test::ProgramResult result = run_setup({"--viewers", "--slicer"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("--slicer"));
}

}  // namespace
}  // namespace bespoke
