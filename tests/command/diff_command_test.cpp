#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "command/example_pair.h"

namespace bespoke::test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

class DiffCommand : public testing::Test {
 protected:
  DiffCommand() {
    EXPECT_EQ(pair_.fit("coarse.vdb", {"--strict", "--tolerance", "0.5%"}).exit_code, 0);
    EXPECT_EQ(pair_.fit("fine.vdb", {"--strict", "--tolerance", "0.1%"}).exit_code, 0);
  }
  std::string file(const std::string& name) const { return pair_.file(name); }
  ProgramResult diff(const std::string& a, const std::string& b,
                     const std::vector<std::string>& extra = {}) const {
    std::vector<std::string> arguments{"diff", file(a), file(b), "-q"};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    return bespoke(arguments);
  }

  ExamplePair pair_;
};

TEST_F(DiffCommand, MeasuresTwoBakesAgainstTheirTolerances) {
  const ProgramResult result = diff("coarse.vdb", "fine.vdb", {"--json", "--product", file("product.obj")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json found = json::parse(result.out);
  // 0.5 % and 0.1 % of the diagonal.
  const double tolerances = 0.006 * extent(read_obj_points(file("source.obj")));
  EXPECT_GT(found["distance"]["max"], 0);
  EXPECT_LE(found["distance"]["max"], tolerances);
  // What the two really do to the product.
  ASSERT_EQ(pair_.apply("coarse.vdb", {"-o", file("a.obj")}).exit_code, 0);
  ASSERT_EQ(pair_.apply("fine.vdb", {"-o", file("b.obj")}).exit_code, 0);
  const Points a = read_obj_points(file("a.obj")), b = read_obj_points(file("b.obj"));
  EXPECT_NEAR(found["products"][0]["distance"]["max"], (a - b).colwise().norm().maxCoeff(),
              4 * float_rounding(a));
  EXPECT_EQ(found["records"]["fields"][0]["name"], "tolerance");
}

TEST_F(DiffCommand, SaysWhetherMapsAreWithinADistance) {
  EXPECT_EQ(diff("fine.vdb", "fine.vdb", {"--within", "0"}).exit_code, 0);
  EXPECT_EQ(diff("coarse.vdb", "fine.vdb", {"--within", "0.6%"}).exit_code, 0);
  const ProgramResult far = diff("coarse.vdb", "fine.vdb", {"--within", "0"});
  EXPECT_EQ(far.exit_code, 3);
  EXPECT_THAT(far.err, AllOf(HasSubstr("apart, more than"), HasSubstr("coarse.vdb")));
  EXPECT_THAT(far.out, HasSubstr("distance"));
}

TEST_F(DiffCommand, WritesWhatItPrints) {
  const ProgramResult printed = diff("coarse.vdb", "fine.vdb");
  ASSERT_EQ(diff("coarse.vdb", "fine.vdb", {"-o", file("diff.txt"), "--threads", "3"}).exit_code, 0);
  EXPECT_EQ(read_text(file("diff.txt")), printed.out);
  EXPECT_THAT(printed.err, IsEmpty());
}

TEST_F(DiffCommand, NamesWhatItCannotCompare) {
  EXPECT_EQ(bespoke({"diff", file("fine.vdb")}).exit_code, 1);
  EXPECT_EQ(diff("fine.vdb", "absent.vdb").exit_code, 4);
  const ProgramResult mesh = diff("fine.vdb", "source.obj");
  EXPECT_EQ(mesh.exit_code, 2);
  EXPECT_THAT(mesh.err, HasSubstr("source.obj"));
  EXPECT_EQ(diff("coarse.vdb", "fine.vdb", {"-o", file("fine.vdb")}).exit_code, 1);
  EXPECT_EQ(diff("coarse.vdb", "fine.vdb", {"--within", "far"}).exit_code, 1);

  std::string text = read_text(file("anchors.json"));
  text.replace(text.find("\"cm\""), 4, "\"mm\"");
  write_text(file("anchors.json"), text);
  ASSERT_EQ(pair_.fit("mm.vdb").exit_code, 0);
  const ProgramResult units = diff("fine.vdb", "mm.vdb");
  EXPECT_EQ(units.exit_code, 2);
  EXPECT_THAT(units.err, AllOf(HasSubstr("is in cm"), HasSubstr("in mm")));

  ASSERT_EQ(bespoke({"invert", file("fine.vdb"), "-o", file("back.vdb"), "-q"}).exit_code, 0);
  EXPECT_THAT(diff("fine.vdb", "back.vdb").err, HasSubstr("different sources"));
}

}  // namespace
}  // namespace bespoke::test
