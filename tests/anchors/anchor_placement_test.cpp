#include "bespoke/anchors/anchor_placement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "bespoke/error.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

const TriangleMesh model = shapes::icosphere(3);

TEST(AnchorPlacement, MeasuresTheDistanceFromTheSurface) {
  const AnchorPlacement on = anchor_placement(model, model.vertices.leftCols(20));
  EXPECT_EQ(on.median_distance, 0);
  EXPECT_FALSE(on.is_far());
  const AnchorPlacement off = anchor_placement(model, 1.5 * model.vertices.leftCols(20));
  EXPECT_NEAR(off.median_distance, 0.5, 1e-6);  // the mesh is read in floats
  EXPECT_THAT(to_string(off), testing::HasSubstr("half of the anchors lie 0.5 or more from the model"));
}

TEST(AnchorPlacement, DistinguishesOtherUnitsFromAnchorsOffTheSurface) {
  const Points anchors = model.vertices.leftCols(40);
  for (const double unit : {0.001, 0.01, 0.1, 1 / 2.54, 2.54, 10.0, 100.0, 1000.0})
    EXPECT_TRUE(anchor_placement(model, unit * anchors).is_far()) << unit;
  // The corners of the bounding box, as the paper adds them, lie as far off as any anchors that are meant.
  EXPECT_FALSE(anchor_placement(model, shapes::cube(2).vertices.array() - 1).is_far());
  // A few that lie close together on the surface.
  EXPECT_FALSE(anchor_placement(model, anchors.leftCols(4)).is_far());
}

TEST(AnchorPlacement, OfASingleAnchorIsMeasuredByTheModel) {
  const Points anchor = model.vertices.leftCols(1);
  EXPECT_FALSE(anchor_placement(model, (1 + 1e-6) * anchor).is_far());
  EXPECT_TRUE(anchor_placement(model, 2.54 * anchor).is_far());
}

TEST(ExchangedSides, AreFarFromTheirModelAndAtTheOther) {
  TriangleMesh target = model;
  target.vertices.colwise() += Vector3(5, 0, 0);
  Anchors right, exchanged, displaced;
  for (int i = 0; i < 20; ++i) {
    const Vector3 a = model.vertices.col(i), b = target.vertices.col(i);
    right.pairs.push_back({"", a, b});
    exchanged.pairs.push_back({"", b, a});
    displaced.pairs.push_back({"", b, 2 * b});
  }
  EXPECT_EQ(exchanged_sides(right, model, target), "");
  EXPECT_THAT(exchanged_sides(exchanged, model, target), testing::HasSubstr("are exchanged"));
  EXPECT_EQ(exchanged_sides(displaced, model, target), "");
  EXPECT_EQ(exchanged_sides(exchanged, model, model), "");  // nobody can tell
  EXPECT_EQ(exchanged_sides({}, model, target), "");
}

TEST(FarPlacement, IsThatOfFarAnchorsByFewAndByMany) {
  const TriangleMesh coarse = shapes::icosphere(1);  // whose vertices are farther apart than a quarter
  for (const Eigen::Index count : {4, 40, 400}) {
    const Points anchors = model.vertices.leftCols(count);
    EXPECT_FALSE(far_placement(coarse, anchors)) << count;
    const std::optional<AnchorPlacement> far = far_placement(coarse, 10 * anchors);
    ASSERT_TRUE(far) << count;
    EXPECT_EQ(far->median_distance, anchor_placement(coarse, 10 * anchors).median_distance);
  }
  EXPECT_THROW(far_placement({}, Points::Zero(3, 1)), InvalidInput);
}

TEST(AnchorPlacement, OfNothingIsNothing) {
  EXPECT_FALSE(anchor_placement(model, Points(3, 0)).is_far());
  EXPECT_THROW(anchor_placement({}, Points::Zero(3, 1)), InvalidInput);
  EXPECT_THROW(anchor_placement(model, Points::Constant(3, 1, std::nan(""))), InvalidInput);
}

}  // namespace
}  // namespace bespoke
