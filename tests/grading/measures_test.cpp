#include "bespoke/grading/measures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "bespoke/error.h"
#include "support/error_message.h"
#include "support/file_text.h"
#include "support/scratch_directory.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class MeasuresTest : public ::testing::Test {
 protected:
  Measures read(const std::string& text) const {
    test::write_text(directory_ / "m.json", text);
    return read_measures(directory_ / "m.json");
  }
  /// What a file with one measure is refused for.
  std::string refusal(const std::string& measure) const {
    try {
      read("{\"measures\":[" + measure + "]}");
    } catch (const FormatError& error) {
      return error.what();
    }
    return "not refused";
  }

  test::ScratchDirectory directory_;
  TriangleMesh sphere_ = shapes::icosphere(4);
  std::map<std::string, Vector3> anchors_{{"north", {0, 1, 0}}, {"east", {1, 0, 0}}, {"south", {0, -1, 0}}};
};

TEST_F(MeasuresTest, FollowTheSurface) {
  const Measures sheet = read(
      "{\"unit\":\"cm\",\"measures\":["
      "{\"name\":\"girth\",\"plane\":{\"point\":[0,0.6,0],\"normal\":[0,1,0]}},"
      "{\"name\":\"quarter\",\"path\":[\"north\",\"east\"]},"
      "{\"name\":\"round\",\"loop\":[\"north\",\"east\",\"south\",[-1,0,0]]}]}");
  EXPECT_EQ(sheet.unit, "cm");
  const std::vector<MeasureLine> lines = measure_lines(sheet.measures, sphere_, anchors_);
  ASSERT_EQ(lines.size(), 3u);
  const double pi = std::numbers::pi;
  EXPECT_NEAR(line_length(lines[0].points, lines[0].closed), 2 * pi * 0.8, 0.02);
  EXPECT_NEAR(line_length(lines[1].points, lines[1].closed), pi / 2, 0.01);
  EXPECT_NEAR(line_length(lines[2].points, lines[2].closed), 2 * pi, 0.03);
}

TEST_F(MeasuresTest, NameWhatIsWrong) {
  EXPECT_THAT(refusal("{\"plane\":{}}"), AllOf(HasSubstr("measure 1"), HasSubstr("\"name\"")));
  EXPECT_THAT(refusal("{\"name\":\"hips\"}"), AllOf(HasSubstr("\"hips\""), HasSubstr("\"loop\"")));
  EXPECT_THAT(refusal("{\"name\":\"hips\",\"plane\":{\"point\":[0,0,0]}}"), HasSubstr("\"normal\""));
  EXPECT_THAT(refusal("{\"name\":\"hips\",\"loop\":[\"a\",\"b\"]}"), HasSubstr("three points"));
  EXPECT_THAT(refusal("{\"name\":\"hips\",\"path\":[\"a\",[1,2]]}"), HasSubstr("three numbers"));
  EXPECT_THAT(refusal("{\"name\":\"a\",\"path\":[\"a\",\"b\"]},{\"name\":\"a\",\"path\":[\"a\",\"b\"]}"),
              AllOf(HasSubstr("measure 2"), HasSubstr("second")));
  EXPECT_THROW(read("[]"), FormatError);
  EXPECT_THROW(read_measures(directory_ / "absent.json"), FileError);
  const std::vector<Measure> unknown{{"sleeve", AnchorLine{{std::string("elbow"), Vector3(1, 0, 0)}, false}}};
  EXPECT_THAT(test::error_message<InvalidInput>([&] { measure_lines(unknown, sphere_, anchors_); }),
              AllOf(HasSubstr("sleeve"), HasSubstr("elbow")));
  const std::vector<Measure> beside{{"hips", Plane{{0, 5, 0}, {0, 1, 0}}}};
  EXPECT_THAT(test::error_message<InvalidInput>([&] { measure_lines(beside, sphere_, anchors_); }),
              AllOf(HasSubstr("hips"), HasSubstr("no closed line")));
}

TEST_F(MeasuresTest, GirthNearALineIsThatOfItsPlane) {
  TriangleMesh larger = sphere_;
  larger.vertices *= 1.25;
  const Points line = closed_sections(sphere_, {{0, 0.6, 0}, {0, 1, 0}}).front();
  EXPECT_NEAR(girth_near(larger, line), 2 * std::numbers::pi * std::sqrt(1.25 * 1.25 - 0.36), 0.03);
  EXPECT_EQ(girth_near(larger, (line.colwise() + Vector3(0, 9, 0)).eval()), 0);
}

}  // namespace
}  // namespace bespoke
