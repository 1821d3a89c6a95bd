#include "bespoke/pipeline/derive_map.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "asset/small_asset.h"
#include "bespoke/asset/asset_io.h"
#include "bespoke/asset/source_surface.h"
#include "bespoke/error.h"
#include "bespoke/lattice/baked_map.h"
#include "bespoke/pipeline/make_map.h"
#include "bespoke/pipeline/summary_json.h"
#include "support/analytic_map.h"

namespace bespoke {
namespace {

constexpr double tolerance = 1e-3;

BakeOptions options() {
  BakeOptions options;
  options.tolerance = tolerance;
  options.error_points = 20000;
  return options;
}

// A certified asset of the space around a sphere.
Asset asset_of(const Vector3& amplitude, const std::string& source_hash, const std::string& target_hash) {
  const AnalyticMap map(
      {{Vector3(0.5, 0, 0), 1.0, amplitude}, {Vector3(-0.5, 0.3, 0), 0.8, 0.5 * amplitude}});
  Asset asset = test::small_asset();
  asset.steps.front().affine = map.affine();
  asset.steps.front().pyramid = bake(map, options()).pyramid;
  asset.steps.front().certificate = certify(asset.steps.front().pyramid, asset.steps.front().affine);
  asset.record.tolerance = tolerance;
  asset.record.source.hash = std::string(64, source_hash[0]);
  asset.record.target.hash = std::string(64, target_hash[0]);
  return with_preview(std::move(asset), test::sphere(Vector3::Zero(), 0.8, 2));
}

Points whole_map(const Asset& asset, const Points& x) {
  return asset.target_from_source * baked_chain(asset.steps)(x);
}

TEST(InvertMap, IsAnAssetThatUndoesTheOther) {
  const Asset forth = asset_of(Vector3(0.1, 0.2, 0), "a", "b");
  ASSERT_TRUE(forth.steps.front().certificate.is_bijection());
  const DerivedMap back = invert_map(forth, options());
  EXPECT_TRUE(back.asset.steps.front().certificate.is_bijection());
  EXPECT_TRUE(back.bake.tolerance_met);
  EXPECT_LE(back.deviation.max, 2 * tolerance);
  EXPECT_EQ(back.asset.record.source.hash, forth.record.target.hash);
  EXPECT_EQ(back.asset.record.target.hash, forth.record.source.hash);
  EXPECT_EQ(back.asset.record.anchors[0].a, forth.record.anchors[0].b);
  const Points x = 2 * Points::Random(3, 2000);
  EXPECT_LT((whole_map(back.asset, whole_map(forth, x)) - x).colwise().norm().maxCoeff(), 2 * tolerance);

  const test::ScratchDirectory scratch;
  write_asset(scratch / "back.vdb", back.asset);
  EXPECT_EQ(read_asset(scratch / "back.vdb").steps.front().pyramid.voxel_count(),
            back.asset.steps.front().pyramid.voxel_count());
}

TEST(DerivedMaps, RecordHalfPrecisionAsFitsDo) {
  const Asset forth = asset_of(Vector3(0.1, 0.2, 0), "a", "b");
  BakeOptions half = options();
  half.precision = ValuePrecision::half;
  const auto recorded = [](const DerivedMap& map) { return Json::parse(map.asset.record.options_json); };
  EXPECT_EQ(recorded(invert_map(forth, half))["half"], true);
  EXPECT_EQ(recorded(compose_maps(forth, forth, half, MeetingModels::may_differ))["half"], true);
  EXPECT_FALSE(recorded(invert_map(forth, options())).contains("half"));
}

TEST(ComposeMaps, ReachAsFarAsTheFartherOne) {
  Asset near = asset_of(Vector3(0.1, 0.2, 0), "a", "b"), far = asset_of(Vector3(0, 0.1, 0.1), "b", "c");
  near.record.lambda = 1;
  far.record.lambda = 3;
  for (const auto& [first, second] : {std::pair(&near, &far), std::pair(&far, &near)})
    EXPECT_EQ(compose_maps(*first, *second, options(), MeetingModels::may_differ).asset.record.lambda, 3);
}

TEST(InvertMap, RefusesAMapThatIsNotCertified) {
  Asset folded = asset_of(Vector3(0.1, 0.2, 0), "a", "b");
  folded.steps.front().certificate.folded = 7;
  try {
    invert_map(folded, options());
    ADD_FAILURE() << "inverted";
  } catch (const InvalidInput& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("7 cells"));
  }
}

TEST(ComposeMaps, IsOneMapAfterTheOther) {
  const Asset first = asset_of(Vector3(0.1, 0.2, 0), "a", "b");
  const Asset second = asset_of(Vector3(0, 0.1, 0.1), "b", "c");
  const DerivedMap both = compose_maps(first, second, options(), MeetingModels::must_be_the_same);
  EXPECT_TRUE(both.asset.steps.front().certificate.is_bijection());
  EXPECT_LE(both.deviation.max, tolerance);
  EXPECT_EQ(both.asset.record.source.hash, first.record.source.hash);
  EXPECT_EQ(both.asset.record.target.hash, second.record.target.hash);
  const Points x = 2 * Points::Random(3, 2000);
  EXPECT_LT((whole_map(both.asset, x) - whole_map(second, whole_map(first, x))).colwise().norm().maxCoeff(),
            1.2 * tolerance);
  const test::ScratchDirectory scratch;
  write_asset(scratch / "both.vdb", both.asset);
  EXPECT_NO_THROW(read_asset(scratch / "both.vdb"));
}

// Two steps, in the frame of the first's source.
Asset chain_asset() {
  Asset asset = asset_of(Vector3(0.1, 0.2, 0), "a", "b");
  asset.steps.push_back(asset_of(Vector3(0.05, -0.1, 0.1), "a", "b").steps.front());
  asset.path = RotationPath::flow;
  return with_preview(std::move(asset), test::sphere(Vector3::Zero(), 0.8, 2));
}

TEST(InvertMap, ReversesTheStepsOfAChain) {
  const Asset forth = chain_asset();
  const DerivedMap back = invert_map(forth, options());
  ASSERT_EQ(back.asset.steps.size(), 2u);
  EXPECT_TRUE(whole_certificate(back.asset).is_bijection());
  const Points x = 2 * Points::Random(3, 2000);
  EXPECT_LT((whole_map(back.asset, whole_map(forth, x)) - x).colwise().norm().maxCoeff(), 3 * tolerance);
  EXPECT_LE(back.deviation.max, 3 * tolerance);
}

TEST(InvertMap, KeepsToItsLeavesOverAllStepsAndNamesWhatMissesTheTolerance) {
  const Asset forth = chain_asset();
  const auto leaves = [](const DerivedMap& map) {
    std::size_t count = 0;
    for (const MapStep& step : map.asset.steps) count += step.pyramid.leaf_count();
    return count;
  };
  const DerivedMap free = invert_map(forth, options());
  ASSERT_TRUE(free.bake.relaxed.empty());
  BakeOptions limited = options();
  limited.max_leaves = leaves(free);
  EXPECT_LE(leaves(invert_map(forth, limited)), *limited.max_leaves);
  limited.max_leaves = leaves(free) / 4;
  const DerivedMap back = invert_map(forth, limited);
  EXPECT_LE(leaves(back), 1.1 * double(*limited.max_leaves));  // a few more for rims
  EXPECT_FALSE(back.bake.relaxed.empty());
  EXPECT_FALSE(back.bake.tolerance_met);
  EXPECT_TRUE(whole_certificate(back.asset).is_bijection());
}

// The model is the one that the previews show.
TEST(InvertMap, SpendsFewLeavesNearTheModelFirst) {
  Asset forth = chain_asset();
  const Points x = test::sphere(Vector3::Zero(), 0.8, 3).vertices;
  BakeOptions limited = options();
  limited.max_leaves = 80;
  const auto error = [&] {
    const DerivedMap back = invert_map(forth, limited);
    return (whole_map(back.asset, whole_map(forth, x)) - x).colwise().norm().mean();
  };
  const double near_the_model = error();
  forth = with_preview(std::move(forth), test::sphere(Vector3(20, 0, 0), 0.8, 2));
  EXPECT_LT(near_the_model, 0.9 * error());
}

// A file's previews may show anything.
TEST(DerivedMaps, DoWithoutAModelWhereThePreviewsShowNone) {
  Asset forth = asset_of(Vector3(0.1, 0.2, 0), "a", "b");
  std::vector<StoredGrid> grids = forth.preview->grids();
  std::fill(grids[1].values.begin(), grids[1].values.end(), 1.0f);
  forth.preview = std::make_shared<const PreviewGrids>(std::move(grids));
  ASSERT_EQ(source_surface(forth).faces.cols(), 0);
  BakeOptions limited = options();
  limited.max_leaves = 60;
  EXPECT_TRUE(whole_certificate(invert_map(forth, limited).asset).is_bijection());
  EXPECT_NO_THROW(compose_maps(forth, forth, limited, MeetingModels::may_differ));
}

TEST(ComposeMaps, JoinsStepsRatherThanGiveUpTheTolerance) {
  const Asset first = asset_of(Vector3(0.1, 0.2, 0), "a", "b");
  const Asset second = asset_of(Vector3(0, 0.1, 0.1), "b", "c");
  const DerivedMap merged = compose_maps(first, second, options(), MeetingModels::must_be_the_same);
  ASSERT_EQ(merged.asset.steps.size(), 1u);
  BakeOptions limited = options();
  limited.max_leaves = merged.asset.steps.front().pyramid.leaf_count() * 3 / 4;
  const DerivedMap both = compose_maps(first, second, limited, MeetingModels::must_be_the_same);
  EXPECT_EQ(both.asset.steps.size(), 2u);
  EXPECT_TRUE(both.bake.relaxed.empty());
  EXPECT_LE(both.deviation.max, tolerance);
}

TEST(DerivedBake, HasTheLeavesOfAFittedMapUnlessAToleranceIsNamed) {
  const BakeOptions unnamed = derived_bake({}, {20, 0.5}, ValuePrecision::half);
  EXPECT_EQ(unnamed.tolerance, 0.5);
  EXPECT_EQ(unnamed.max_leaves, default_options(1).bake.max_leaves);
  EXPECT_EQ(unnamed.precision, ValuePrecision::half);
  const BakeOptions named = derived_bake(Length{1, true}, {20, 0.5}, ValuePrecision::single);
  EXPECT_DOUBLE_EQ(named.tolerance, 0.2);
  EXPECT_FALSE(named.max_leaves);
}

TEST(ComposeMaps, JoinsChains) {
  const Asset first = chain_asset();
  const Asset second = asset_of(Vector3(0, 0.1, 0.1), "b", "c");
  const DerivedMap both = compose_maps(first, second, options(), MeetingModels::must_be_the_same);
  EXPECT_EQ(both.asset.steps.size(), 3u);
  EXPECT_EQ(both.asset.path, RotationPath::flow);
  EXPECT_TRUE(whole_certificate(both.asset).is_bijection());
  const Points x = 2 * Points::Random(3, 2000);
  EXPECT_LT((whole_map(both.asset, x) - whole_map(second, whole_map(first, x))).colwise().norm().maxCoeff(),
            1.2 * tolerance);
}

TEST(ComposeMaps, RefusesModelsThatDoNotMeetUnlessTold) {
  const Asset first = asset_of(Vector3(0.1, 0.2, 0), "a", "b");
  EXPECT_THROW(compose_maps(first, first, options(), MeetingModels::must_be_the_same), InvalidInput);
  EXPECT_NO_THROW(compose_maps(first, first, options(), MeetingModels::may_differ));
}

}  // namespace
}  // namespace bespoke
