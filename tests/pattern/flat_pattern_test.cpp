#include "bespoke/pattern/flat_pattern.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "bespoke/error.h"
#include "bespoke/parallel.h"
#include "bespoke/pattern/sheet/grain.h"
#include "bespoke/pattern/sheet/sheet_formats.h"
#include "bespoke/pattern/write_pattern.h"
#include "pattern/mesh_parts.h"
#include "pattern/tubes.h"
#include "support/error_message.h"

namespace bespoke {
namespace {

using ::testing::HasSubstr;

/// Half of a ball of radius 100 mm, open below.
Garment hemisphere() {
  return test::garment_of(test::part_of(test::ball(), [](const Vector3& x) { return x.y() > 0; }).mesh);
}

TEST(FlatPattern, OfATubeIsARectangleWithItsGrainUpright) {
  const double height = 400, radius = 60;
  PatternOptions options;
  options.cut.auto_cut = true;
  const FlatPattern pattern =
      flat_pattern(test::garment_of(test::tube(36, 20, radius, height)), nullptr, options);
  const Eigen::Matrix2Xd& flat = pattern.pieces.at(0).flat;
  const Eigen::Vector2d size = flat.rowwise().maxCoeff() - flat.rowwise().minCoeff();
  EXPECT_NEAR(size.x(), 36 * test::side_of(36, radius), 1e-4);
  EXPECT_NEAR(size.y(), height, 1e-4);
  EXPECT_NEAR(pattern.pieces[0].strain.max, 1, 1e-6);
  EXPECT_FALSE(pattern.pieces[0].dart);
  ASSERT_EQ(pattern.seams.size(), 1u);
  EXPECT_NEAR(pattern.seams[0].lengths[0], height, 1e-4);
}

TEST(FlatPattern, DartsRelieveAHemisphere) {
  const FlatPattern whole = flat_pattern(hemisphere(), nullptr);
  EXPECT_GT(whole.pieces.at(0).strain.strain_p95, 0.1);
  ASSERT_TRUE(whole.pieces[0].dart);
  PatternOptions options;
  options.max_darts = 6;
  const FlatPattern darted = flat_pattern(hemisphere(), nullptr, options);
  EXPECT_EQ(darted.darts, 6);
  EXPECT_LT(darted.pieces[0].strain.strain_p95, whole.pieces[0].strain.strain_p95 / 2);
  EXPECT_THAT(to_string(darted, options), HasSubstr("p95"));
}

TEST(FlatPattern, MoreDartsAreNeverWorse) {
  double strain = std::numeric_limits<double>::infinity();
  for (const int darts : {0, 1, 3, 9}) {
    PatternOptions options;
    options.max_darts = darts;
    const FlatPattern pattern = flat_pattern(hemisphere(), nullptr, options);
    EXPECT_LE(pattern.darts, darts);
    EXPECT_FALSE(pattern.pieces.at(0).overlap) << darts << " darts";
    EXPECT_LE(pattern.pieces[0].strain.strain_p95, strain) << darts << " darts";
    strain = pattern.pieces[0].strain.strain_p95;
  }
}

// A map that shears the tube takes its upright grain along.
TEST(FlatPattern, TheSourceGivesGrainAndStrain) {
  const Garment source = test::garment_of(test::tube(36, 20, 60, 400));
  Garment carried = source;
  carried.mesh.vertices *= 1.25;
  PatternOptions options;
  options.cut.auto_cut = true;
  const FlatPattern pattern = flat_pattern(carried, &source, options);
  ASSERT_TRUE(pattern.pieces.at(0).source_strain);
  EXPECT_NEAR(pattern.pieces[0].source_strain->max, 1, 1e-6);
  const Eigen::Matrix2Xd& flat = pattern.pieces[0].flat;
  EXPECT_NEAR(flat.row(1).maxCoeff() - flat.row(1).minCoeff(), 500, 1e-4);
  Garment other = source;
  other.mesh.faces.conservativeResize(3, 10);
  EXPECT_THAT(test::error_message<InvalidInput>([&] { flat_pattern(carried, &other, options); }),
              HasSubstr("its faces are not those"));
}

TEST(StretchBeyond, CountsWhatClothCannot) {
  const Garment garment = test::garment_of(test::tube(36, 20, 60, 400));
  const CutPieces cut = cut_pieces(garment, {.auto_cut = true});
  const FlatPieces flat = flatten_pieces(cut.pieces, {});
  const Eigen::Vector2d grain = grain_along(cut.pieces[0], flat.places[0], Vector3::UnitY());
  Eigen::Matrix2d shrink = Eigen::Matrix2d::Identity() - 0.1 * grain * grain.transpose();
  const StretchExcess excess = stretch_beyond(cut.pieces[0], shrink * flat.places[0], grain, {0.05, 0.05});
  EXPECT_NEAR(excess.warp_max, 1 / 0.9 - 1, 1e-6);
  EXPECT_NEAR(excess.weft_max, 0, 1e-6);
  EXPECT_NEAR(excess.area_share, 1, 1e-9);
}

TEST(FlatPattern, HasTheSameBytesAtAnyThreadCount) {
  const auto bytes = [] {
    const FlatPattern pattern = flat_pattern(hemisphere(), nullptr);
    return pattern_json(pattern, pattern_sheet(pattern), {.name = "hemisphere"});
  };
  std::string alone;
  run_alone([&] { alone = bytes(); });
  EXPECT_EQ(alone, bytes());
}

}  // namespace
}  // namespace bespoke
