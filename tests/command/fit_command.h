#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "command/example_pair.h"

namespace bespoke::test {

using nlohmann::json;

/// A pair of models to fit, and what the command says.
class FitCommand : public testing::Test {
 protected:
  json info(const std::string& map) const {
    const ProgramResult result = bespoke({"info", pair_.file(map), "--json"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return json::parse(result.out);
  }
  json read_json(const std::string& name) const { return json::parse(read_text(pair_.file(name))); }

  /// Expects the fit to refuse with the exit code and a message that holds the text, leaving nothing behind.
  void expect_refusal(const ProgramResult& result, int exit_code, const std::string& text) const {
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    EXPECT_THAT(result.err, testing::HasSubstr(text));
    EXPECT_FALSE(pair_.has("map.vdb"));
  }

  ExamplePair pair_;
};

}  // namespace bespoke::test
