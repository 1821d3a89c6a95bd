#include "bespoke/certificate/fold_list.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <random>

namespace bespoke {
namespace {

// Two levels of random values, strong enough to fold some cells and not others.
Pyramid rough_pyramid() {
  Pyramid pyramid;
  pyramid.levels.push_back({1, {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}}, {}});
  pyramid.levels.push_back({0.5, {{0, 1, 1}, {1, 1, 2}}, {}});
  std::mt19937 engine(7);
  for (PyramidLevel& level : pyramid.levels) {
    std::uniform_real_distribution<float> value(-0.25f * static_cast<float>(level.voxel_size),
                                                0.25f * static_cast<float>(level.voxel_size));
    level.values.resize(leaf_floats * level.leaves.size());
    for (float& v : level.values) v = value(engine);
  }
  return pyramid;
}

std::vector<Vector3> sorted_centers(const std::vector<FoldedCell>& cells) {
  std::vector<Vector3> centers;
  for (const FoldedCell& cell : cells) centers.push_back(cell.center);
  std::sort(centers.begin(), centers.end(), [](const Vector3& a, const Vector3& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  });
  return centers;
}

// What is certified anew around changed nodes is all that a whole certificate would find.
TEST(FoldList, AgreesWithTheWholeCertificateAfterEachChange) {
  Pyramid pyramid = rough_pyramid();
  const AffineMap affine;
  FoldList list(pyramid, affine, certify_listing_all(pyramid, affine).places);
  ASSERT_FALSE(list.places().empty());
  std::mt19937 engine(8);
  for (int round = 0; round < 20; ++round) {
    const std::size_t level = engine() % pyramid.levels.size();
    PyramidLevel& changed = pyramid.levels[level];
    const std::size_t leaf = engine() % changed.leaves.size();
    const int number = static_cast<int>(engine() % leaf_nodes);
    float* value = changed.values_of(leaf) + 3 * number;
    std::fill(value, value + 3, 0.0f);
    std::vector<std::vector<LatticeCoordinates>> nodes(pyramid.levels.size());
    nodes[level].push_back(moved(first_node(changed.leaves[leaf]), place_of_number(number)));
    list.update(nodes);
    const std::vector<FoldedCell> expected = certify_listing_all(pyramid, affine).places;
    ASSERT_EQ(sorted_centers(list.places()), sorted_centers(expected)) << "round " << round;
  }
}

}  // namespace
}  // namespace bespoke
