#include "bespoke/catalog/map_index.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace bespoke {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

MapIndexRow row(const std::string& name, bool bijection) {
  MapIndexRow row;
  row.name = name;
  row.t = 0.5;
  row.page = "page of " + name + ".html";
  row.picture = name + ".png";
  row.products = {"a<b.obj", "c.obj"};
  row.map.file = "../maps/x.vdb";
  row.map.unit = "cm";
  row.map.bijection = bijection;
  row.map.min_determinant = 0.25;
  row.map.folded = 7;
  return row;
}

TEST(MapIndex, LeadsFromPicturesToPages) {
  const std::string page = map_index({row("M", true), row("L", false)}, {});
  EXPECT_THAT(page, AllOf(HasSubstr("<h1>2 results</h1>"), HasSubstr("src=\"M.png\""),
                          HasSubstr("href=\"page%20of%20M.html\""), HasSubstr("href=\"../maps/x.vdb\""),
                          HasSubstr("a&lt;b.obj<br>c.obj"), HasSubstr(">0.5<")));
  EXPECT_THAT(page, AllOf(HasSubstr("det ≥ 0.25"), HasSubstr("7 cells fold"), Not(HasSubstr("Not made"))));
}

TEST(MapIndex, NamesWhatCouldNotBeMade) {
  EXPECT_THAT(map_index({}, {"XL & more"}), AllOf(HasSubstr("<h1>0 results</h1>"), HasSubstr("Not made"),
                                                  HasSubstr("<li>XL &amp; more</li>")));
}

}  // namespace
}  // namespace bespoke
