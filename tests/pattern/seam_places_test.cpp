#include "bespoke/pattern/detail/seam_places.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "bespoke/pattern/sheet/piece_marks.h"
#include "bespoke/pattern/size_table.h"
#include "pattern/tubes.h"
#include "support/error_message.h"

namespace bespoke {
namespace {

using ::testing::HasSubstr;

constexpr int sides = 24, rows = 10;
constexpr double radius = 100, height = 300;

/// A tube, cut along two of its lines into "front" and "back".
PatternOptions in_halves() {
  PatternOptions options;
  options.cut.seams.emplace();
  for (const int line : {0, sides / 2}) {
    SeamCut cut;
    for (int r = 0; r + 1 < rows; ++r) cut.edges.push_back({r * sides + line, (r + 1) * sides + line});
    options.cut.seams->cuts.push_back(cut);
  }
  options.cut.seams->names = {{"front", sides / 4}, {"back", 3 * sides / 4}};
  options.cut.seams->widths = {{"waist", 4 * sides + 5}};
  return options;
}

Garment tube() { return test::garment_of(test::tube(sides, rows, radius, height)); }

const PatternSeam& seam_along(const FlatPattern& pattern, std::size_t number) {
  return pattern.seams.at(number);
}

TEST(Ease, MakesOneSideLonger) {
  PatternOptions options = in_halves();
  options.cut.seams->cuts[0].ease = 6;
  options.cut.seams->cuts[0].longer = "back";
  const FlatPattern pattern = flat_pattern(tube(), nullptr, options);
  ASSERT_EQ(pattern.seams.size(), 2u);
  int eased = 0;
  for (const PatternSeam& seam : pattern.seams) {
    const bool has_ease = seam.seam.ease != 0;
    eased += has_ease ? 1 : 0;
    const std::size_t back =
        pattern.pieces[static_cast<std::size_t>(seam.seam.sides[0].piece)].piece.name == "back" ? 0 : 1;
    EXPECT_NEAR(seam.lengths[back] - seam.lengths[1 - back], has_ease ? 6 : 0, 1);
    EXPECT_FALSE(seam.differs);
  }
  EXPECT_EQ(eased, 1);
  EXPECT_THAT(to_string(pattern, options), HasSubstr("ease 6 mm"));
}

TEST(Ease, IsTakenByNumber) {
  PatternOptions options = in_halves();
  options.eases = {{2, -6}};
  const FlatPattern pattern = flat_pattern(tube(), nullptr, options);
  EXPECT_NEAR(seam_along(pattern, 0).lengths[0] - seam_along(pattern, 0).lengths[1], 0, 1);
  EXPECT_NEAR(seam_along(pattern, 1).lengths[1] - seam_along(pattern, 1).lengths[0], 6, 1);
}

TEST(Ease, IsRefusedWhereNothingTakesIt) {
  PatternOptions options = in_halves();
  options.eases = {{3, 5}};
  EXPECT_THAT(test::error_message<InvalidInput>([&] { flat_pattern(tube(), nullptr, options); }),
              HasSubstr("the pattern has the seams 1 … 2"));
  options.eases.clear();
  options.cut.seams->cuts[0].ease = 5;
  options.cut.seams->cuts[0].longer = "sleeve";
  EXPECT_THAT(test::error_message<InvalidInput>([&] { flat_pattern(tube(), nullptr, options); }),
              HasSubstr("no piece is called so"));
}

// Anchors lie on a body within the tube: one beside the first seam at a third of its height, one far from
// both.
TEST(Notches, AreWhereSeamsPassAnchors) {
  PatternOptions options = in_halves();
  options.marks = {{"side", {3, height / 3, radius - 20}}, {"front", {radius - 20, height / 3, 0}}};
  const FlatPattern pattern = flat_pattern(tube(), nullptr, options);
  std::size_t marks = 0;
  for (const PatternSeam& seam : pattern.seams) {
    marks += seam.marks.size();
    if (seam.marks.empty()) continue;
    const auto notches = seam_notches(pattern, seam);
    EXPECT_EQ(notches[0].size(), notches[1].size());
    for (std::size_t side = 0; side < 2; ++side) {
      const PatternPiece& piece = pattern.pieces[static_cast<std::size_t>(seam.seam.sides[side].piece)];
      EXPECT_NEAR(notches[side].back().at.y() - piece.flat.row(1).minCoeff(), height / 3, 0.01);
    }
  }
  EXPECT_EQ(marks, 1u);
}

TEST(Widths, StandInTheTableOfSizes) {
  const PatternOptions options = in_halves();
  const FlatPattern pattern = flat_pattern(tube(), nullptr, options);
  ASSERT_EQ(pattern.widths.size(), 1u);
  const PatternPiece& piece = pattern.pieces[static_cast<std::size_t>(pattern.widths[0].piece)];
  const auto [left, right] = width_at(outline_places(piece), piece.flat.col(pattern.widths[0].vertex));
  EXPECT_NEAR(right.x() - left.x(), sides / 2 * test::side_of(sides, radius), 1e-3);
  EXPECT_THAT(size_table_csv({{"M", pattern}}), HasSubstr("front,width at waist,mm,313"));
}

}  // namespace
}  // namespace bespoke
