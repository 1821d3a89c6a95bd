#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <sstream>

#include "command/refusal.h"
#include "support/file_text.h"
#include "support/scratch_directory.h"

namespace bespoke::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr int sides = 24;

/// A tube of 10 cm radius and 30 cm height in centimetres, in two groups, open at both ends.
std::string tube_obj(bool in_halves = true) {
  std::ostringstream text;
  text.precision(12);
  for (int row = 0; row < 4; ++row)
    for (int s = 0; s < sides; ++s) {
      const double angle = 2 * std::numbers::pi * s / sides;
      text << "v " << 10 * std::sin(angle) << " " << 10 * row << " " << 10 * std::cos(angle) << "\n";
    }
  for (int s = 0; s < sides; ++s) {
    if (in_halves && s == 0) text << "g front\n";
    if (in_halves && s == sides / 2) text << "g back\n";
    for (int row = 0; row < 3; ++row) {
      const int a = row * sides + s + 1, b = row * sides + (s + 1) % sides + 1;
      text << "f " << a << " " << b << " " << b + sides << " " << a + sides << "\n";
    }
  }
  return text.str();
}

class FlattenCommand : public testing::Test {
 protected:
  std::string file(const std::string& name) const { return (directory_ / name).string(); }
  std::string product(const std::string& text) const {
    write_text(file("garment.obj"), text);
    return file("garment.obj");
  }
  ProgramResult flatten(const std::string& text, const std::vector<std::string>& extra) const {
    std::vector<std::string> arguments{"flatten", product(text)};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    return bespoke(arguments);
  }

  ScratchDirectory directory_;
};

TEST_F(FlattenCommand, WritesThePiecesOfAGarment) {
  for (const char* ending : {"svg", "dxf", "pdf", "json", "glb"}) {
    const std::string output = file(std::string("pieces.") + ending);
    const ProgramResult result =
        flatten(tube_obj(), {"--unit", "cm", "-o", output, "--seam-allowance", "10"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, AllOf(HasSubstr("2, 2 seams"), HasSubstr("front"), HasSubstr("back"),
                                  HasSubstr("stretch 1.000 … 1.000")));
    EXPECT_FALSE(read_text(output).empty());
  }
}

TEST_F(FlattenCommand, MeasuresTheSourceBeside) {
  write_text(file("source.obj"), tube_obj());
  const ProgramResult result = flatten(tube_obj(), {"--source", file("source.obj"), "--unit", "cm",
                                                    "--stretch-limit", "3,10", "-o", file("pieces.json")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("source"));
}

TEST_F(FlattenCommand, RefusesInOneSentence) {
  const std::string output = file("pieces.svg");
  expect_refusal(flatten(tube_obj(), {"-o", output}), 2, "--unit cm");
  expect_refusal(flatten(tube_obj(false), {"--unit", "cm", "-o", output}), 2, "2 boundary loops");
  expect_refusal(flatten("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", {"--unit", "cm", "-o", output}), 2,
                 "one triangle");
  expect_refusal(
      flatten("v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 4\nf 1 2 3\n", {"--unit", "cm", "-o", output}), 2,
      "face 2 has no area");
  expect_refusal(flatten("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nf 1 2 3\nf 2 1 4\nf 1 2 5\n",
                         {"--unit", "cm", "-o", output}),
                 2, ".obj: three pieces or more meet along the edge between vertices 1 and 2");
  expect_refusal(flatten(tube_obj(), {"--unit", "cm", "-o", file("pieces.png")}), 1, ".svg, .dxf, .pdf");
  expect_refusal(flatten(tube_obj(), {"--unit", "cm", "--stretch-limit", "3", "-o", output}), 1, "warp,weft");
  write_text(file("seams.json"), "{\"seams\":[{\"path\":[1,999]}]}");
  expect_refusal(flatten(tube_obj(), {"--unit", "cm", "--seams", file("seams.json"), "-o", output}), 2,
                 "vertex 999 is none");
  EXPECT_FALSE(std::filesystem::exists(output));
}

TEST_F(FlattenCommand, HasTheSameBytesAtAnyThreadCount) {
  for (const char* threads : {"1", "3"})
    ASSERT_EQ(
        flatten(tube_obj(), {"--unit", "cm", "--threads", threads, "-o", file(std::string(threads) + ".svg")})
            .exit_code,
        0);
  EXPECT_EQ(read_text(file("1.svg")), read_text(file("3.svg")));
}

TEST(GradeFlatten, NestsTheSizesOfAProduct) {
  const ExamplePair pair;
  write_text(pair.file("tube.obj"), tube_obj(false));
  const ProgramResult result =
      bespoke({"grade", pair.file("source.obj"), pair.file("tube.obj"), "--target", pair.file("target.obj"),
               "--anchors", pair.file("anchors.json"), "--between", "1", "--out-dir", pair.file("sizes"),
               "--flatten", pair.file("tube.obj"), "--flatten-unit", "cm", "--auto-cut"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(read_text(pair.file("sizes/tube_pattern.csv")),
              AllOf(HasSubstr("piece,measure,unit,source,1_of_2,2_of_2\n"), HasSubstr(",area,cm2,")));
  EXPECT_THAT(read_text(pair.file("sizes/tube_pattern.svg")), HasSubstr("inkscape:label=\"size 1_of_2\""));
  EXPECT_THAT(read_text(pair.file("sizes/tube_pattern.dxf")), HasSubstr("SIZE_SOURCE"));
  expect_refusal(bespoke({"grade", pair.file("source.obj"), pair.file("tube.obj"), "--target",
                          pair.file("target.obj"), "--anchors", pair.file("anchors.json"), "--out-dir",
                          pair.file("sizes"), "--flatten", pair.file("other.obj")}),
                 1, "is none of the products that are carried");
}

}  // namespace
}  // namespace bespoke::test
