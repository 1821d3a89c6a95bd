#include "bespoke/anchors/anchors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "bespoke/error.h"
#include "bespoke/rigid/rigid_transform.h"
#include "product/text_dialects.h"
#include "support/error_message.h"
#include "support/file_text.h"
#include "support/scratch_directory.h"

namespace bespoke {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class ReadAnchors : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& text) {
    test::write_text(directory_ / name, text);
    return directory_ / name;
  }

  std::string message_for(const std::string& name, const std::string& text) {
    return test::error_message<FormatError>([&] { read_anchors(write(name, text)); });
  }

  /// A file of one good and one given pair.
  std::string message_for_pair(const std::string& pair) {
    return message_for("anchors.json",
                       R"({"pairs": [{"name": "good", "a": [0,0,0], "b": [1,2,3]}, )" + pair + "]}");
  }

  test::ScratchDirectory directory_;
};

TEST_F(ReadAnchors, ReadsJson) {
  const Anchors anchors = read_anchors(write("anchors.json", R"({
    "units": "cm", "comment": "extra keys are no concern of the reader",
    "pairs": [{"name": "chin", "a": [1, 2.5, -3e-1], "b": [4, 5, 6], "a_vertex": 17},
              {"a": [7, 8, 9], "b": [10, 11, 12], "weight": 0.5}]})"));
  EXPECT_EQ(anchors.unit, "cm");
  ASSERT_EQ(anchors.pairs.size(), 2u);
  EXPECT_EQ(anchors.pairs[0].name, "chin");
  EXPECT_EQ(anchors.pairs[0].a, Vector3(1, 2.5, -0.3));
  EXPECT_TRUE(std::isinf(anchors.pairs[0].weight));
  EXPECT_EQ(anchors.pairs[1].name, "");
  EXPECT_EQ(anchors.pairs[1].b, Vector3(10, 11, 12));
  EXPECT_EQ(anchors.pairs[1].weight, 0.5);
  EXPECT_EQ(source_points(anchors).col(1), Vector3(7, 8, 9));
  EXPECT_EQ(target_points(anchors).col(0), Vector3(4, 5, 6));
  EXPECT_EQ(weights(anchors)[1], 0.5);
}

TEST_F(ReadAnchors, CsvSaysTheSameAsJson) {
  const std::string rows =
      "chin,1,2.5,-3e-1,4,5,6\r\n\r\n\"left, ear\", 7, 8 ,9,10,11,12,0.5\n,1,1,1,2,2,2,\n";
  const std::string header = "\xEF\xBB\xBFname,ax,ay,az,bx,by,bz,weight\r\n";
  for (const std::string& text : {rows, header + rows}) {
    const Anchors anchors = read_anchors(write("anchors.CSV", text));
    ASSERT_EQ(anchors.pairs.size(), 3u);
    EXPECT_EQ(anchors.pairs[0].name, "chin");
    EXPECT_EQ(anchors.pairs[0].a, Vector3(1, 2.5, -0.3));
    EXPECT_TRUE(std::isinf(anchors.pairs[0].weight));
    EXPECT_EQ(anchors.pairs[1].name, "left, ear");
    EXPECT_EQ(anchors.pairs[1].b, Vector3(10, 11, 12));
    EXPECT_EQ(anchors.pairs[1].weight, 0.5);
    EXPECT_TRUE(std::isinf(anchors.pairs[2].weight));
  }
}

TEST_F(ReadAnchors, ReadsTheTextsOfSpreadsheets) {
  const std::string rows = "chin,1,2.5,-3e-1,4,5,6,0.5\n\"left, ear\",7,8,9.25,10,11,12,\n";
  const std::string header = "name,ax,ay,az,bx,by,bz,sigma\n";
  std::vector<test::TextDialect> dialects = test::line_dialects();
  const auto german = [](const std::string& separator) {
    return [separator](const std::string& text) {
      std::string result;
      bool is_quoted = false;
      for (const char c : text) {
        is_quoted = is_quoted != (c == '"');
        result += is_quoted || (c != ',' && c != '.') ? std::string(1, c) : c == ',' ? separator : ",";
      }
      return result;
    };
  };
  dialects.push_back({"semicolons and decimal commas", german(";")});
  dialects.push_back({"tabs and decimal commas", german("\t")});
  dialects.push_back(
      {"a named separator", [=](const std::string& text) { return "sep=;\n" + german(";")(text); }});
  for (const test::TextDialect& dialect : dialects) {
    SCOPED_TRACE(dialect.name);
    const Anchors anchors = read_anchors(write("anchors.csv", dialect.of(header + rows)));
    ASSERT_EQ(anchors.pairs.size(), 2u);
    EXPECT_EQ(anchors.pairs[0].a, Vector3(1, 2.5, -0.3));
    EXPECT_EQ(anchors.pairs[0].sigma, 0.5);
    EXPECT_EQ(anchors.pairs[1].name, "left, ear");
    EXPECT_EQ(anchors.pairs[1].a, Vector3(7, 8, 9.25));
    EXPECT_EQ(anchors.pairs[1].b, Vector3(10, 11, 12));
    EXPECT_EQ(
        read_anchors(write("rows.csv", dialect.of(rows.substr(0, rows.find('\n') - 4) + "\n"))).pairs[0].a,
        Vector3(1, 2.5, -0.3));
  }
  const auto complaint = [&](const std::string& name, const std::string& text) {
    return test::error_message<FormatError>([&] { read_anchors(write(name, text)); });
  };
  EXPECT_THAT(complaint("a.csv", "chin;1,5;2;3;4;5;6\near;1.5;2;3;4;5;6\n"),
              HasSubstr("line 2: \"1.5\" has a decimal point"));
  EXPECT_THAT(complaint("a.csv", "chin,1,2,3,4,5,6\n\"ear,1,2,3,4,5,6\n"),
              HasSubstr("line 2: a quote that does not end"));
  for (const char* name : {"a.csv", "a.json"})
    EXPECT_THAT(complaint(name, test::utf16(header + rows, false, true)),
                HasSubstr("is UTF-16; save as UTF-8"));
}

TEST_F(ReadAnchors, ReadsAccuracies) {
  const Anchors json = read_anchors(write("anchors.json", R"({"pairs": [
    {"a": [0,0,0], "b": [1,1,1], "sigma": 0}, {"a": [0,0,0], "b": [1,1,1], "sigma": 0.25},
    {"a": [0,0,0], "b": [1,1,1]}]})"));
  const Anchors csv =
      read_anchors(write("anchors.csv", ",0,0,0,1,1,1,,0\n,0,0,0,1,1,1,,0.25\n,0,0,0,1,1,1\n"));
  const Anchors named = read_anchors(write("named.csv",
                                           "name,ax,ay,az,bx,by,bz,sigma\n,0,0,0,1,1,1,0\n"
                                           ",0,0,0,1,1,1,0.25\n,0,0,0,1,1,1,\n"));
  for (const Anchors& anchors : {json, csv, named}) {
    ASSERT_EQ(anchors.pairs.size(), 3u);
    EXPECT_EQ(anchors.pairs[0].sigma, 0.0);
    EXPECT_EQ(anchors.pairs[1].sigma, 0.25);
    EXPECT_EQ(anchors.pairs[2].sigma, std::nullopt);
    EXPECT_TRUE(is_exact(anchors.pairs[0]));
    EXPECT_FALSE(is_exact(anchors.pairs[1]));
    EXPECT_EQ(sigmas(anchors), Vector3(0, 0.25, 0));
  }
}

TEST_F(ReadAnchors, RefusesAccuraciesThatAreNoLengths) {
  EXPECT_THAT(message_for_pair(R"({"a": [0,0,0], "b": [0,0,0], "sigma": -1})"),
              AllOf(HasSubstr("\"sigma\" is -1"), HasSubstr(">= 0")));
  EXPECT_THAT(message_for_pair(R"({"a": [0,0,0], "b": [0,0,0], "sigma": "small"})"),
              HasSubstr("\"sigma\" is string"));
  EXPECT_THAT(message_for_pair(R"({"a": [0,0,0], "b": [0,0,0], "sigma": 1, "weight": 2})"),
              HasSubstr("both a weight and a sigma"));
  EXPECT_THAT(message_for("a.csv", "n,1,2,3,4,5,6,,-1\n"), HasSubstr("sigma is -1"));
  EXPECT_THAT(message_for("a.csv", "n,1,2,3,4,5,6,2,1\n"), HasSubstr("both a weight and a sigma"));
  EXPECT_THAT(message_for("a.csv", "n,1,2,3,4,5,6,2,1,0\n"), HasSubstr("10 columns"));
}

TEST(SplineWeights, FallWithTheSquareOfSigma) {
  Anchors anchors;
  for (const double sigma : {0.0, 0.01, 0.02})
    anchors.pairs.push_back({"", Vector3(sigma, 0, 1), Vector3(100 * sigma, 1, 0), 7, sigma});
  const Eigen::VectorXd found = spline_weights(anchors);
  EXPECT_EQ(found[0], 7);
  EXPECT_NEAR(found[1], std::pow(0.1 * 2 / 0.01, 2), 1e-9);
  EXPECT_NEAR(found[1] / found[2], 4, 1e-12);
}

TEST_F(ReadAnchors, NamesThePairAndTheKeyAtFault) {
  EXPECT_THAT(
      message_for_pair(R"({"name": "chin", "a": [0,0,0]})"),
      AllOf(HasSubstr("anchors.json"), HasSubstr("pair 1 (\"chin\")"), HasSubstr("\"b\" is missing")));
  EXPECT_THAT(message_for_pair(R"({"name": "chin", "a": [0,0], "b": [0,0,0]})"),
              AllOf(HasSubstr("\"a\""), HasSubstr("three numbers")));
  EXPECT_THAT(message_for_pair(R"({"a": [0,"1",0], "b": [0,0,0]})"),
              AllOf(HasSubstr("pair 1"), HasSubstr("\"a\"[1] is string")));
  EXPECT_THAT(message_for_pair(R"({"a": [0,null,0], "b": [0,0,0]})"), HasSubstr("\"a\"[1] is null"));
  EXPECT_THAT(message_for_pair(R"({"a": [0,0,0], "b": [0,0,0], "weight": 0})"),
              AllOf(HasSubstr("\"weight\" is 0"), HasSubstr("> 0")));
  EXPECT_THAT(message_for_pair(R"({"a": [0,0,0], "b": [0,0,0], "weight": "heavy"})"),
              HasSubstr("\"weight\" is string"));
  EXPECT_THAT(message_for_pair(R"({"name": 7, "a": [0,0,0], "b": [0,0,0]})"),
              HasSubstr("\"name\" is number"));
  EXPECT_THAT(message_for_pair(R"({"name": "two\nlines", "a": [0,0,0], "b": [0,0,0]})"),
              HasSubstr("control character"));
  EXPECT_THAT(message_for_pair(R"({"name": "good", "a": [0,0,0], "b": [0,0,0]})"),
              HasSubstr("two pairs are named \"good\""));
  EXPECT_THAT(message_for_pair("[1, 2, 3]"), HasSubstr("pair 1 is array, not an object"));
  EXPECT_THAT(message_for_pair(R"({"a": [0, -1e40, 0], "b": [0, 0, 0]})"),
              HasSubstr("\"a\"[1] is not finite in single precision"));
}

TEST_F(ReadAnchors, RejectsWhatIsNotAListOfPairs) {
  EXPECT_THAT(message_for("a.json", ""), HasSubstr("not valid JSON"));
  EXPECT_THAT(message_for("a.json", R"({"pairs": [{"a": [NaN, 0, 0], "b": [0,0,0]}]})"),
              HasSubstr("not valid JSON"));
  EXPECT_THAT(message_for("a.json", R"({"pairs": [{"a": [1e999, 0, 0], "b": [0,0,0]}]})"),
              HasSubstr("not valid JSON"));
  EXPECT_THAT(message_for("a.json", "[]"), HasSubstr("\"pairs\""));
  EXPECT_THAT(message_for("a.json", "{}"), HasSubstr("\"pairs\" is missing"));
  EXPECT_THAT(message_for("a.json", R"({"pairs": 3})"), HasSubstr("not an array"));
  EXPECT_THAT(message_for("a.json", R"({"units": 1, "pairs": []})"), HasSubstr("\"units\""));
}

TEST_F(ReadAnchors, NamesTheCsvLineAtFault) {
  EXPECT_THAT(message_for("a.csv", "n,1,2,3,4,5,6\nm,1,2,3,4,5,x\n"),
              AllOf(HasSubstr("a.csv: line 2"), HasSubstr("bz is \"x\"")));
  EXPECT_THAT(message_for("a.csv", "n,nan,2,3,4,5,6\n"), AllOf(HasSubstr("line 1"), HasSubstr("ax")));
  EXPECT_THAT(message_for("a.csv", "n,1,2,3,4,5,inf\n"), HasSubstr("not a finite number"));
  EXPECT_THAT(message_for("a.csv", "n,1,2,3,4,5e200,6\n"), HasSubstr("line 1: by is not finite in single"));
  EXPECT_THAT(message_for("a.csv", "n,1,2,3,4,5,6,-1\n"), HasSubstr("weight is -1"));
  EXPECT_THAT(message_for("a.csv", "\n\nn,1,2,3,4,5\n"), AllOf(HasSubstr("line 3"), HasSubstr("6 columns")));
  EXPECT_THAT(message_for("a.csv", "name,x,y,z,bx,by,bz\n"), HasSubstr("line 1: ax is \"x\""));
  EXPECT_THAT(message_for("a.csv", "n,1,2,3,4,5,6\nn,1,2,3,4,5,6\n"), HasSubstr("two pairs are named \"n\""));
  EXPECT_THAT(message_for("a.csv", ""), HasSubstr("no rows"));
}

TEST_F(ReadAnchors, ReportsAFileThatCannotBeOpened) {
  EXPECT_THROW(read_anchors("/nonexistent/anchors.json"), FileError);
  EXPECT_THROW(read_anchors(directory_.path()), FileError);
}

// The corners of a box, and a point inside that must not matter.
Points box_points(const Vector3& low, const Vector3& high) {
  Points points(3, 3);
  points << low, high, 0.5 * (low + high);
  return points;
}

TEST(AddBoxCorners, PairsTheCornersByTheirSides) {
  Anchors anchors;
  const Points source = box_points(Vector3(0, 0, 0), Vector3(1, 2, 3));
  const Points target = box_points(Vector3(4, 4, 4), Vector3(5, 6, 7));
  add_box_corners(anchors, source, target);
  ASSERT_EQ(anchors.pairs.size(), 8u);
  EXPECT_EQ(anchors.pairs[0].name, "corner_000");
  EXPECT_EQ(anchors.pairs[4].name, "corner_100");
  EXPECT_EQ(anchors.pairs[4].a, Vector3(1, 0, 0));
  EXPECT_EQ(anchors.pairs[4].b, Vector3(5, 4, 4));
  EXPECT_EQ(anchors.pairs[7].a, Vector3(1, 2, 3));
  EXPECT_EQ(anchors.pairs[7].b, Vector3(5, 6, 7));
  EXPECT_THROW(add_box_corners(anchors, source, target), InvalidInput);
  Anchors none;
  EXPECT_THROW(add_box_corners(none, Points(3, 0), Points(3, 0)), InvalidInput);
}

// The box of a turned model has other corners than the turned box.
TEST(AddBoxCorners, TurnWithTheTarget) {
  const Matrix3 rotation = Eigen::AngleAxisd(0.7, Vector3(1, 2, -1).normalized()).toRotationMatrix();
  const RigidTransform turn{rotation, Vector3(3, -1, 2)};
  const Points source = Points::Random(3, 50);
  Anchors anchors;
  for (int i = 0; i < 4; ++i) {
    AnchorPair pair;
    pair.name = std::string(1, static_cast<char>('p' + i));
    pair.a = source.col(i);
    pair.b = turn * Points(pair.a);
    anchors.pairs.push_back(pair);
  }
  add_box_corners(anchors, source, turn * source);
  ASSERT_EQ(anchors.pairs.size(), 12u);
  for (const AnchorPair& pair : anchors.pairs)
    EXPECT_LT((turn * Points(pair.a) - Points(pair.b)).norm(), 1e-12) << pair.name;
}

}  // namespace
}  // namespace bespoke
