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
  /// What a file with these measures is refused for.
  std::string refusal(const std::string& measures) const {
    return test::error_message<FormatError>([&] { read("{\"measures\":[" + measures + "]}"); });
  }

  test::ScratchDirectory directory_;
  TriangleMesh sphere_ = shapes::icosphere(5);
  AnchorPlaces anchors_{{"north", {0, 1, 0}}, {"east", {1, 0, 0}}, {"south", {0, -1, 0}}};
};

TEST_F(MeasuresTest, FollowTheSurface) {
  const Measures sheet = read(
      "{\"units\":\"cm\",\"measures\":["
      "{\"name\":\"girth\",\"plane\":{\"point\":[0,0.6,0],\"normal\":[0,1,0]}},"
      "{\"name\":\"quarter\",\"path\":[\"north\",\"east\"]},"
      "{\"name\":\"round\",\"loop\":[\"north\",\"east\",\"south\",[-1,0,0]]}]}");
  EXPECT_EQ(sheet.unit, "cm");
  const std::vector<MeasureLine> lines = measure_lines(sheet.measures, sphere_, anchors_);
  ASSERT_EQ(lines.size(), 3u);
  const double pi = std::numbers::pi;
  EXPECT_NEAR(line_length(lines[0].points, lines[0].closed), 2 * pi * 0.8, 5e-3);
  EXPECT_NEAR(line_length(lines[1].points, lines[1].closed), pi / 2, 2e-3);
  EXPECT_NEAR(line_length(lines[2].points, lines[2].closed), 2 * pi, 8e-3);
}

TEST_F(MeasuresTest, NameTheFileAndTheMeasureThatIsWrong) {
  EXPECT_THAT(refusal("{\"plane\":{}}"), AllOf(HasSubstr("m.json: measure 1"), HasSubstr("\"name\"")));
  EXPECT_THAT(refusal("{\"name\":\"hips\"}"), AllOf(HasSubstr("\"hips\""), HasSubstr("\"loop\"")));
  EXPECT_THAT(refusal("{\"name\":\"hips\",\"plane\":{\"point\":[0,0,0]}}"), HasSubstr("\"normal\""));
  EXPECT_THAT(refusal("{\"name\":\"hips\",\"plane\":{\"point\":[0,0,0],\"normal\":[0,0,0]}}"),
              HasSubstr("normal of its plane is zero"));
  EXPECT_THAT(refusal("{\"name\":\"hips\",\"loop\":[\"a\",\"b\"]}"), HasSubstr("three points"));
  EXPECT_THAT(refusal("{\"name\":\"hips\",\"path\":[\"a\",[1,2]]}"), HasSubstr("three numbers"));
  EXPECT_THAT(refusal("{\"name\":\"hips\",\"ring\":[\"a\",\"b\"]}"), HasSubstr("unknown key \"ring\""));
  EXPECT_THAT(refusal("{\"name\":\"a\",\"path\":[\"a\",\"b\"],\"loop\":[\"a\",\"b\",\"c\"]}"),
              HasSubstr("only one"));
  EXPECT_THAT(refusal("{\"name\":\"a\",\"path\":[\"a\",\"b\"]},{\"name\":\"a\",\"path\":[\"a\",\"b\"]}"),
              AllOf(HasSubstr("measure 2"), HasSubstr("second \"a\"")));
  EXPECT_THAT(refusal(""), HasSubstr("is empty"));
  EXPECT_THAT(refusal("{"), HasSubstr("line 1"));
  EXPECT_THROW(read("[]"), FormatError);
  EXPECT_THROW(read("{\"units\":3,\"measures\":[{\"name\":\"a\",\"path\":[\"a\",\"b\"]}]}"), FormatError);
  EXPECT_THROW(read_measures(directory_ / "absent.json"), FileError);
}

TEST_F(MeasuresTest, NameTheMeasureThatTheSourceLacks) {
  const std::vector<Measure> unknown{{"sleeve", AnchorLine{{std::string("elbow"), Vector3(1, 0, 0)}, false}}};
  EXPECT_THAT(test::error_message<InvalidInput>([&] { measure_lines(unknown, sphere_, anchors_); }),
              AllOf(HasSubstr("sleeve"), HasSubstr("elbow")));
  const std::vector<Measure> beside{{"hips", Plane{{0, 5, 0}, {0, 1, 0}}}};
  EXPECT_THAT(test::error_message<InvalidInput>([&] { measure_lines(beside, sphere_, anchors_); }),
              AllOf(HasSubstr("hips"), HasSubstr("no closed line")));
}

TEST_F(MeasuresTest, AreFoundOnTheModelOfASize) {
  const std::vector<MeasureLine> lines =
      measure_lines({{"girth", Plane{{0, 0.6, 0}, {0, 1, 0}}},
                     {"quarter", AnchorLine{{std::string("north"), Vector3(1, 0, 0)}, false}}},
                    sphere_, anchors_);
  // The map misses the model, by a shift of the plane and by its scale; the model's own lengths are told.
  const SizeModel model{shapes::moved(sphere_, {1.25 * Matrix3::Identity(), Vector3::Zero()}),
                        {{"north", {0, 1.25, 0}}}};
  const ImageOfPoints image = [](const Points& x) -> Points {
    return (1.2 * x).colwise() + Vector3(0, 0.03, 0);
  };
  const double pi = std::numbers::pi;
  EXPECT_NEAR(length_on(model, lines[0], image).value(), 2 * pi * std::sqrt(1.25 * 1.25 - 0.75 * 0.75), 8e-3);
  EXPECT_NEAR(length_on(model, lines[1], image).value(), 1.25 * pi / 2, 0.04);
  const ImageOfPoints away = [](const Points& x) -> Points { return x.colwise() + Vector3(0, 9, 0); };
  EXPECT_FALSE(length_on(model, lines[0], away));
}

}  // namespace
}  // namespace bespoke
