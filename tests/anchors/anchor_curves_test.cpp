#include "bespoke/anchors/anchor_curves.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "bespoke/anchors/anchor_files.h"
#include "bespoke/error.h"
#include "support/error_message.h"
#include "support/file_text.h"
#include "support/scratch_directory.h"

namespace bespoke {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const Points corner{{0, 3, 3}, {0, 0, 1}, {0, 0, 0}};  // lengths 3 and 1

Points circle(int points, double begin, double direction) {
  Points result(3, points);
  for (int i = 0; i < points; ++i) {
    const double angle = begin + direction * 2 * std::numbers::pi * i / points;
    result.col(i) = Vector3(std::cos(angle), std::sin(angle), 0);
  }
  return result;
}

TEST(AnchorCurves, ArePlacedByTheirLength) {
  EXPECT_EQ(point_along(corner, false, 0), Vector3(0, 0, 0));
  EXPECT_EQ(point_along(corner, false, 0.5), Vector3(2, 0, 0));
  EXPECT_EQ(point_along(corner, false, 0.875), Vector3(3, 0.5, 0));
  EXPECT_EQ(point_along(corner, false, 1), Vector3(3, 1, 0));
  EXPECT_EQ(point_along(corner, true, 1), Vector3(0, 0, 0));
}

TEST(AnchorCurves, KnowTheirNearestPlace) {
  EXPECT_EQ(nearest_along(corner, false, {1, -2, 0}), Vector3(1, 0, 0));
  EXPECT_EQ(nearest_along(corner, false, {9, 9, 0}), Vector3(3, 1, 0));
  EXPECT_DOUBLE_EQ(distance_from_polyline(corner, false, Points(Vector3(1, -2, 0))), 2);
  EXPECT_NEAR(distance_from_polyline(corner, true, Points(Vector3(1.5, 0.5, 0))), 0, 1e-15);
}

TEST(CurvePairs, LieAtEqualSharesOfLength) {
  Anchors anchors;
  anchors.curves = {{"seam", corner, 2 * corner, false, {}}};
  const Anchors pairs = CurvePairs(anchors, 0.5).pairs(0.1);
  ASSERT_EQ(pairs.pairs.size(), 9u);
  for (const AnchorPair& pair : pairs.pairs) {
    EXPECT_LT((pair.b - 2 * pair.a).norm(), 1e-12);
    EXPECT_EQ(pair.sigma, 0.1);
  }
  EXPECT_TRUE(pairs.curves.empty());
}

// A seam from one pair to another, and a second seam that begins on it.
TEST(CurvePairs, LeavePlacesThatAreTakenToWhatIsThere) {
  Anchors anchors;
  anchors.pairs = {{"begin", corner.col(0), corner.col(0)}, {"beside", {1, 0.2, 0}, {1, 0.2, 0}}};
  anchors.curves = {{"seam", corner, corner, false, {}},
                    {"branch", Points{{2, 2}, {0, 1}, {0, 0}}, Points{{2, 2}, {0, 1}, {0, 0}}, false, {}}};
  CurvePairs curves(anchors, 0.5);
  const Anchors pairs = curves.pairs(0.1);
  ASSERT_EQ(pairs.pairs.size(), 2u + 7u + 2u);
  EXPECT_EQ(curves.sources().cols(), 9);
  for (std::size_t i = 0; i < pairs.pairs.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_GE((pairs.pairs[i].a - pairs.pairs[j].a).norm(), 0.25) << i << " and " << j;
}

// The second point of a, at three quarters of its length, belongs to the middle of b.
TEST(CurvePairs, KeepFixedPoints) {
  Anchors anchors;
  anchors.curves = {{"seam", corner, Points{{0, 1, 2}, {0, 0, 0}, {0, 0, 0}}, false, {{1, 1}}}};
  CurvePairs curves(anchors, 0.5);
  Points nowhere = curves.sources();
  nowhere.setConstant(9);
  curves.slide(nowhere, 9);  // all but the fixed point are drawn to the end of b
  int fixed = 0;
  double last = -1;
  for (const AnchorPair& pair : curves.pairs(0.1).pairs) {
    EXPECT_GT(pair.b.x(), last);
    last = pair.b.x();
    fixed += *pair.sigma == 0;
    EXPECT_EQ(*pair.sigma == 0, pair.a == Vector3(3, 0, 0));
    EXPECT_EQ(*pair.sigma == 0, pair.b == Vector3(1, 0, 0));
  }
  EXPECT_EQ(fixed, 1);
  EXPECT_EQ(last, 2);
}

TEST(CurvePairs, KeepAFixedEndThatIsNoEndOfTheOther) {
  Anchors anchors;
  anchors.curves = {{"seam", corner, Points{{0, 1, 2}, {0, 0, 0}, {0, 0, 0}}, false, {{2, 1}}}};
  const Anchors pairs = CurvePairs(anchors, 0.5).pairs(0.1);
  EXPECT_EQ(pairs.pairs.back().a, Vector3(3, 1, 0));
  EXPECT_EQ(pairs.pairs.back().b, Vector3(1, 0, 0));
  EXPECT_EQ(pairs.pairs.back().sigma, 0);
}

TEST(CurvePairs, SlideToTheNearestPlaces) {
  Anchors anchors;
  const Points line{{0, 10}, {0, 0}, {0, 0}};
  anchors.curves = {{"seam", line, line, false, {}}};
  CurvePairs curves(anchors, 1);
  Points places = curves.sources();
  for (auto&& x : places.colwise()) x += Vector3(0.1 * std::sin(x.x()), 0.3, 0);
  curves.slide(places, 1);
  const Anchors slid = curves.pairs(0);
  for (Eigen::Index i = 1; i + 1 < places.cols(); ++i)
    EXPECT_NEAR(slid.pairs[static_cast<std::size_t>(i)].b.x(), places(0, i), 1e-12);
}

// Drawn to one place, and beyond an end, they wait in their order.
TEST(CurvePairs, StayApartWhereAllAreDrawnToOnePlace) {
  Anchors anchors;
  const Points line{{0, 10}, {0, 0}, {0, 0}};
  anchors.curves = {{"seam", line, line, false, {}}};
  for (const double drawn : {-20.0, 5.0, 20.0}) {
    CurvePairs curves(anchors, 1);
    Points places = curves.sources();
    places.row(0).setConstant(drawn);
    curves.slide(places, 9);
    const std::vector<AnchorPair> slid = curves.pairs(0).pairs;
    ASSERT_EQ(slid.size(), 11u);
    for (std::size_t i = 1; i < slid.size(); ++i)
      EXPECT_GE(slid[i].b.x() - slid[i - 1].b.x(), 0.25 - 1e-12) << drawn;
  }
}

// Neither past each other nor onto each other, and no farther than the reach.
TEST(CurvePairs, SlideInTheirOrder) {
  Anchors anchors;
  for (const Vector3& x : {Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1)})
    anchors.pairs.push_back({"", 3 * x, 3 * x});
  for (const int direction : {1, -1}) {
    anchors.curves = {{"waist", circle(90, 0, 1), circle(90, 1, direction), true, {}}};
    CurvePairs curves(anchors, 0.1);
    const Points sources = curves.sources();
    std::mt19937 engine(5);
    std::normal_distribution<double> noise(0, 0.2);
    Points places = sources;
    for (double& x : places.reshaped()) x += noise(engine);
    const double reach = 0.5;
    curves.slide(places, reach);
    const auto angle = [](const Vector3& x) { return std::atan2(x.y(), x.x()); };
    const Anchors slid = curves.pairs(0);
    const auto count = static_cast<std::size_t>(sources.cols());
    const double even = 2 * std::numbers::pi / static_cast<double>(count);
    for (std::size_t i = 0; i < count; ++i) {
      const AnchorPair &pair = slid.pairs[3 + i], &next = slid.pairs[3 + (i + 1) % count];
      EXPECT_GT(std::remainder(angle(next.b) - angle(pair.b), 2 * std::numbers::pi), 0.2 * even);
      EXPECT_LT(std::abs(std::remainder(angle(pair.b) - angle(pair.a), 2 * std::numbers::pi)), reach + even);
    }
  }
}

/// A straight curve of eleven pairs, its counterpart moved by what `asked` says of a place.
template <class Asked>
Anchors bent_line(const Asked& asked) {
  Anchors anchors;
  Points a(3, 11), b(3, 11);
  for (int i = 0; i < 11; ++i) a.col(i) = Vector3(i, 0, 0);
  for (int i = 0; i < 11; ++i) b.col(i) = a.col(i) + asked(a.col(i));
  anchors.curves = {{"seam", a, b, false, {}}};
  return anchors;
}

/// The pairs of bent_line after they gave way to places along the straight line.
std::vector<AnchorPair> given_way(const Anchors& anchors, const Points& held) {
  CurvePairs curves(anchors, 1);
  curves.slide(anchors.curves[0].b, 9);
  curves.give_way(anchors.curves[0].a, held);
  return curves.pairs(0).pairs;
}

TEST(CurvePairs, GiveNoWayWhereTheyAreGentle) {
  const Anchors anchors = bent_line([](const Vector3& x) { return Vector3(0, 0.2 * x.x(), 1); });
  const std::vector<AnchorPair> pairs = given_way(anchors, Points(3, 0));
  ASSERT_EQ(pairs.size(), 11u);
  for (std::size_t i = 0; i < pairs.size(); ++i)
    EXPECT_LT((pairs[i].b - anchors.curves[0].b.col(static_cast<Eigen::Index>(i))).norm(), 1e-12);
}

TEST(CurvePairs, GiveWayWhereTheyWouldFoldTheSurface) {
  const Anchors anchors =
      bent_line([](const Vector3& x) { return Vector3(0, 2 * std::sin(2 * x.x()), 0.1 * x.x()); });
  const Points held = Vector3(5, 0, 0);
  const std::vector<AnchorPair> pairs = given_way(anchors, held);
  ASSERT_EQ(pairs.size(), 11u);
  const auto moved = [](const AnchorPair& pair) { return Vector3(pair.b - pair.a); };
  for (const AnchorPair& pair : pairs) {
    const double from_held = (pair.a - held.col(0)).norm();
    EXPECT_LE(moved(pair).cwiseAbs().maxCoeff(), from_held / 4 + 1e-9);
    for (const AnchorPair& other : pairs)
      EXPECT_LE((moved(pair) - moved(other)).cwiseAbs().maxCoeff(), (pair.a - other.a).norm() / 4 + 1e-9);
  }
}

// A circle that begins elsewhere and runs the other way is the same curve.
TEST(CurvePairs, FindWhereAClosedCurveBegins) {
  const Vector3 shift(5, 0, 0);
  Anchors anchors;
  for (const Vector3& x : {Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1)})
    anchors.pairs.push_back({"", x, x + shift});
  anchors.curves = {{"waist", circle(90, 0, 1), circle(120, 2, -1).colwise() + shift, true, {}}};
  const Anchors pairs = CurvePairs(anchors, 0.1).pairs(0);
  EXPECT_GE(pairs.pairs.size(), 63u);
  for (const AnchorPair& pair : pairs.pairs) EXPECT_LT((pair.b - shift - pair.a).norm(), 0.03);
}

TEST(CurvePairs, DoNotGuessWhereAClosedCurveBegins) {
  Anchors anchors;
  for (const Vector3& x : {Vector3(1, 0, 0), Vector3(0, 1, 0)}) anchors.pairs.push_back({"", x, x});
  anchors.curves = {{"waist", circle(90, 0, 1), circle(90, 0, 1), true, {}}};
  EXPECT_THAT(test::error_message<InvalidInput>([&] { CurvePairs(anchors, 0.1); }),
              AllOf(HasSubstr("\"waist\""), HasSubstr("there are 2"), HasSubstr("\"fixed\"")));
  anchors.curves[0].fixed = {{0, 0}};
  EXPECT_NO_THROW(CurvePairs(anchors, 0.1));
}

class CurveFiles : public ::testing::Test {
 protected:
  std::string complaint(const std::string& curve) const {
    test::write_text(directory_ / "a.json", R"({"curves": [)" + curve + "]}");
    return test::error_message<FormatError>([&] { read_anchors(directory_ / "a.json"); });
  }
  test::ScratchDirectory directory_;
};

TEST_F(CurveFiles, AreReadAsTheyWereWritten) {
  Anchors anchors;
  anchors.curves = {{"waist", corner, circle(7, 1, 1), true, {{0, 2}, {1, 6}}},
                    {"", corner, corner, false, {}}};
  write_anchor_files({directory_ / "a.json"}, anchors);
  const Anchors back = read_anchors(directory_ / "a.json");
  ASSERT_EQ(back.curves.size(), 2u);
  EXPECT_EQ(back.curves[0].name, "waist");
  EXPECT_EQ(back.curves[0].a, corner);
  EXPECT_EQ(back.curves[0].b, anchors.curves[0].b);
  EXPECT_TRUE(back.curves[0].closed);
  EXPECT_EQ(back.curves[0].fixed, anchors.curves[0].fixed);
  EXPECT_FALSE(back.curves[1].closed);
}

TEST_F(CurveFiles, NameWhatIsWrong) {
  const std::string line = R"([[0,0,0],[1,0,0]])";
  EXPECT_EQ(complaint(R"({"a": )" + line + R"(, "b": )" + line + "}"), "accepted");
  EXPECT_THAT(complaint(R"({"name": "waist", "a": )" + line + "}"),
              HasSubstr(R"(curve 0 ("waist"): key "b" is missing)"));
  EXPECT_THAT(complaint(R"({"a": [[0,0,0]], "b": )" + line + "}"), HasSubstr("two points at least"));
  EXPECT_THAT(complaint(R"({"a": [[0,0,0],[0,0,0]], "b": )" + line + "}"), HasSubstr("at one place"));
  EXPECT_THAT(complaint(R"({"a": [[0,0,0],[1,"x",0]], "b": )" + line + "}"), HasSubstr("point 1"));
  EXPECT_THAT(complaint(R"({"a": )" + line + R"(, "b": )" + line + R"(, "fixed": [[0, 2]]})"),
              HasSubstr("by their numbers from 0"));
  EXPECT_THAT(complaint(R"({"a": )" + line + R"(, "b": )" + line + R"(, "fixed": [[1, 1], [0, 0]]})"),
              HasSubstr("rising"));
}

}  // namespace
}  // namespace bespoke
