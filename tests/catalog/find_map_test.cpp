#include "bespoke/catalog/find_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "support/error_message.h"

namespace bespoke {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class FindMap : public ::testing::Test {
 protected:
  FindMap() {
    add("anna.vdb", "aaaaaa11", "bbbbbb11");
    add("ben.vdb", "aaaaaa11", "cccccc11");
    add("foot.vdb", "aaaaaa22", "cccccc11");
  }
  void add(const std::string& file, const std::string& source, const std::string& target) {
    CatalogEntry entry;
    entry.file = file;
    entry.source.hash = source;
    entry.target.hash = target;
    catalog_.assets.push_back(entry);
  }
  std::string found(const std::string& source, const std::string& target = {}) const {
    return find_map(catalog_, {source, target}).file;
  }
  std::string refusal(const std::string& source, const std::string& target = {}) const {
    return test::error_message<InvalidInput>([&] { found(source, target); });
  }

  Catalog catalog_;
};

TEST_F(FindMap, GoesByTheFirstDigits) {
  EXPECT_EQ(found("aaaaaa22"), "foot.vdb");
  EXPECT_EQ(found("AAAAAA2"), "foot.vdb");
  EXPECT_EQ(found("aaaaaa11", "cccccc"), "ben.vdb");
  EXPECT_EQ(found("aaaaaa", "bbbbbb11"), "anna.vdb");
}

TEST_F(FindMap, NamesTheMapsThatThereAre) {
  EXPECT_THAT(refusal("aaaaaa11"), AllOf(HasSubstr("anna.vdb (target bbbbbb11)"), HasSubstr("ben.vdb")));
  EXPECT_THAT(refusal("aaaaaa11", "dddddd"), AllOf(HasSubstr("to the target dddddd"), HasSubstr("ben.vdb")));
  EXPECT_THAT(refusal("dddddd"), HasSubstr("it has 3 maps"));
  EXPECT_THAT(refusal("aaaaaa", "cccccc"), AllOf(HasSubstr("ben.vdb"), HasSubstr("foot.vdb")));
}

TEST_F(FindMap, TakesAnyOfCopiesButAsksWhichOfMapsBetweenTheSameModels) {
  add("copy.vdb", "aaaaaa22", "cccccc11");
  EXPECT_THAT(refusal("aaaaaa22"), AllOf(HasSubstr("2 maps lead from the source aaaaaa22 to the same target"),
                                         HasSubstr("foot.vdb"), HasSubstr("copy.vdb"),
                                         HasSubstr("give one of them as MAP, without --from")));
  for (CatalogEntry& entry : catalog_.assets) entry.sha256 = "of " + entry.file;
  EXPECT_THAT(refusal("aaaaaa22", "cccccc11"), HasSubstr("to the same target"));
  catalog_.assets.back().sha256 = catalog_.assets[2].sha256;
  EXPECT_EQ(found("aaaaaa22"), "foot.vdb");
}

TEST_F(FindMap, RefusesWhatIsNoHash) {
  for (const std::string bad : {"", "aaaaa", "body.obj", "aaaaaag"})
    EXPECT_THAT(refusal(bad), HasSubstr("hexadecimal")) << bad;
  EXPECT_THAT(refusal("aaaaaa", "b"), HasSubstr("target's hash"));
}

}  // namespace
}  // namespace bespoke
