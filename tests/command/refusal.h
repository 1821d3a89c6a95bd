#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "command/example_pair.h"

namespace bespoke::test {

/// The last line is the command's own and holds the text; nothing follows it.
inline void expect_refusal(const ProgramResult& result, int exit_code, const std::string& text) {
  EXPECT_EQ(result.exit_code, exit_code) << result.err;
  const std::string last = result.err.substr(result.err.rfind("bespoke: "));
  EXPECT_THAT(last, testing::AllOf(testing::StartsWith("bespoke: "), testing::HasSubstr(text)));
  EXPECT_EQ(last.find('\n'), last.size() - 1) << "more than one line";
}

/// What stands in a file, and what the command says of it.
struct BadFile {
  const char* name;
  std::string content;
  const char* message;
};

}  // namespace bespoke::test
