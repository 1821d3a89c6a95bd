#include "bespoke/lattice/pyramid_part.h"

#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "bespoke/lattice/baked_map.h"
#include "support/elastic_map_contract.h"
#include "support/pyramid_part_of.h"
#include "support/random_pyramid.h"

namespace bespoke {
namespace {

TEST(PyramidPart, KnowsAllLeavesAndIsValid) {
  std::mt19937 engine(1);
  const Pyramid whole = test::random_pyramid(4, 1);
  const PyramidPart part = test::part_of(whole, test::random_box(engine, 2));
  EXPECT_EQ(part.leaf_count(), whole.leaf_count());
  EXPECT_LT(part.read.leaf_count(), whole.leaf_count());
  EXPECT_NO_THROW(require_valid(part));
}

TEST(PyramidPart, IsRefusedWhereItContradictsItself) {
  const Box box(Vector3(-1, -1, 0), Vector3(1, 1, 2));
  const PyramidPart sound = test::part_of(test::random_pyramid(3, 2), box);
  ASSERT_FALSE(sound.read.levels[1].leaves.empty());
  PyramidPart part = sound;
  part.leaves.pop_back();
  EXPECT_THROW(require_valid(part), InvalidInput);
  part = sound;
  std::erase(part.leaves[2], part.leaves[2].front());
  EXPECT_NO_THROW(require_valid(part)) << "a leaf without values may be left out";
  part.leaves[1] = {};
  EXPECT_THROW(require_valid(part), InvalidInput);
  part = sound;
  std::erase(part.leaves[1], part.read.levels[1].leaves.front());
  EXPECT_THROW(require_valid(part), InvalidInput);
  part = sound;
  part.read.levels[1].values.pop_back();
  EXPECT_THROW(require_valid(part), InvalidInput);
  part = sound;
  part.read.levels[0].values.front() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(require_valid(part), InvalidInput);
}

TEST(LeavesNear, HoldTheCellsOfPointsAndTheirUpperNeighbours) {
  std::mt19937 engine(3);
  const Lattice lattice{Vector3(0.25, -1, 2), 0.125};
  for (int n = 0; n < 200; ++n) {
    const Box box = test::random_box(engine, 3);
    const LeafBox leaves = leaves_near(lattice, box);
    const Points x = test::points_in(box, 20, engine);
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      const LeafCoordinates leaf = leaf_of(lattice.cell_of(Vector3(x.col(i))));
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LE(leaves.low[axis], leaf[axis]);
        EXPECT_GE(leaves.high[axis], leaf[axis] + 1);
        EXPECT_GE(leaves.low[axis], leaf_of(lattice.cell_of(box.min()))[axis] - 1) << "no more than needed";
        EXPECT_LE(leaves.high[axis], leaf_of(lattice.cell_of(box.max()))[axis] + 2);
      }
    }
  }
}

TEST(LeavesNear, OfBoxesBeyondAllLatticesAreNoLeavesOfOne) {
  const LeafBox leaves =
      leaves_near({Vector3::Zero(), 1e-5}, {Vector3::Constant(1e30), Vector3::Constant(2e30)});
  for (int axis = 0; axis < 3; ++axis) EXPECT_GT(leaves.low[axis], 1 << 26);
}

TEST(ImageBox, HoldsTheImagesOfAllPointsOfTheBox) {
  std::mt19937 engine(4);
  const Pyramid whole = test::random_pyramid(3, 4);
  const AffineMap affine = test::some_affine();
  const BakedMap map(affine, whole);
  for (int n = 0; n < 50; ++n) {
    const Box box = test::random_box(engine, 3);
    const Box images = image_box(box, affine, test::part_of(whole, box));
    const Points image = map(test::points_in(box, 500, engine));
    const double rounding = 1e-12 * images.sizes().norm();
    for (Eigen::Index i = 0; i < image.cols(); ++i)
      EXPECT_LE(images.exteriorDistance(Vector3(image.col(i))), rounding);
  }
}

}  // namespace
}  // namespace bespoke
