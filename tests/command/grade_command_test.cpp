#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>

#include "command/example_pair.h"

namespace bespoke::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// The number in a column of measures.csv, by the measure's name; -1 without.
double cell(const std::string& csv, const std::string& measure, int column) {
  const std::size_t line = csv.find("\n" + measure + ",");
  if (line == std::string::npos) return -1;
  std::size_t at = line + 1;
  for (int i = 0; i < column; ++i) at = csv.find(',', at) + 1;
  double number = -1;
  std::sscanf(csv.c_str() + at, "%lf", &number);
  return number;
}

class GradeCommand : public testing::Test {
 protected:
  GradeCommand() {
    write_text(file("measures.json"),
               "{\"unit\":\"cm\",\"measures\":[{\"name\":\"waist\",\"plane\":{\"point\":[0,0,0],\"normal\":["
               "0,1,0]}},"
               "{\"name\":\"side\",\"path\":[\"p1\",\"p4\"]}]}");
  }
  std::string file(const std::string& name) const { return pair_.file(name); }
  ProgramResult grade(const std::vector<std::string>& extra) const {
    std::vector<std::string> arguments{"grade",      file("source.obj"),    file("product.obj"),
                                       "--measures", file("measures.json"), "--out-dir",
                                       file("sizes")};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    return bespoke(arguments);
  }

  ExamplePair pair_;
};

TEST_F(GradeCommand, GivesEverySizeAFolderWithItsProductsAndMeasures) {
  write_text(file("sizes.csv"),
             "size,target,anchors\nM," + file("target.obj") + "," + file("anchors.json") + "\n");
  const ProgramResult result = grade({"--sizes", file("sizes.csv")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("# M"), HasSubstr("| waist |")));
  EXPECT_TRUE(pair_.has("sizes/M/product.obj"));
  EXPECT_TRUE(pair_.has("sizes/M/map.vdb"));
  const std::string csv = read_text(file("sizes/M/measures.csv"));
  // The target is an ellipsoid of radii 1.1, 1.3, 0.95: its girth across the second is that of the first and
  // third.
  EXPECT_NEAR(cell(csv, "waist", 1), 5.673, 0.02);
  EXPECT_NEAR(cell(csv, "waist", 2), 6.449, 0.03);
  EXPECT_NEAR(cell(csv, "waist", 3), 6.449, 0.03);
  EXPECT_GT(cell(csv, "side", 2), 0);
  EXPECT_THAT(grade({"--sizes", file("sizes.csv")}).err, HasSubstr("3 up to date"));
}

TEST_F(GradeCommand, FillsTheSizesBetweenFromOneMap) {
  const ProgramResult result =
      grade({"--target", file("target.obj"), "--anchors", file("anchors.json"), "--between", "1", "-q"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string half = read_text(file("sizes/1_of_2/measures.csv"));
  const std::string whole = read_text(file("sizes/2_of_2/measures.csv"));
  EXPECT_GT(cell(half, "waist", 2), cell(half, "waist", 1));
  EXPECT_LT(cell(half, "waist", 2), cell(whole, "waist", 2));
  const ProgramResult apply =
      bespoke({"apply", file("sizes/map.vdb"), file("product.obj"), "-o", file("half.obj"), "--t", "0.5"});
  ASSERT_EQ(apply.exit_code, 0) << apply.err;
  EXPECT_EQ(read_text(file("half.obj")), read_text(file("sizes/1_of_2/product.obj")));
}

TEST_F(GradeCommand, SaysWhatIsMissing) {
  EXPECT_EQ(grade({}).exit_code, 1);
  EXPECT_EQ(grade({"--sizes", file("a.csv"), "--target", file("target.obj")}).exit_code, 1);
  EXPECT_EQ(grade({"--sizes", file("absent.csv")}).exit_code, 4);
  write_text(file("sizes.csv"), "size,target\n../x," + file("target.obj") + "\n");
  EXPECT_THAT(grade({"--sizes", file("sizes.csv")}).err, HasSubstr("sizes.csv:2"));
  write_text(file("sizes.csv"), "size,target\nM," + file("absent.obj") + "\n");
  EXPECT_THAT(grade({"--sizes", file("sizes.csv")}).err, HasSubstr("absent.obj does not exist"));
}

}  // namespace
}  // namespace bespoke::test
