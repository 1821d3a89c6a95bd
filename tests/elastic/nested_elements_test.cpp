#include "bespoke/elastic/detail/nested_elements.h"

#include <gtest/gtest.h>

#include "bespoke/lattice/baked_map.h"
#include "support/random_points.h"

namespace bespoke {
namespace {

/// Three levels around the origin: all nodes of a cube, then two smaller and smaller sets.
NestedElements three_levels() {
  std::vector<std::vector<LatticeCoordinates>> nodes(3);
  for (int i = -2; i <= 2; ++i)
    for (int j = -2; j <= 2; ++j)
      for (int k = -2; k <= 2; ++k) nodes[0].push_back({i, j, k});
  nodes[1] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 1}, {-2, 1, 0}};
  nodes[2] = {{1, 1, 1}, {2, 3, 1}};
  return {{Vector3(0.1, 0.2, 0.3), 0.5}, nodes};
}

Points random_coefficients(const NestedElements& elements, unsigned seed) {
  return test::random_points(static_cast<Eigen::Index>(elements.unknowns()), seed);
}

double product(const Points& a, const Points& b) { return a.cwiseProduct(b).sum(); }

TEST(NestedElements, FinestCellsTileTheCoarsestOnes) {
  const NestedElements elements = three_levels();
  double volume = 0;
  for (const ElementLevel& level : elements.levels())
    volume += static_cast<double>(level.finest.size()) * std::pow(level.voxel_size, 3);
  EXPECT_NEAR(volume, static_cast<double>(elements.levels()[0].cells.size()) * 0.125, 1e-12);
  EXPECT_LT(elements.levels()[0].finest.size(), elements.levels()[0].cells.size());
  EXPECT_FALSE(elements.levels()[2].finest.empty());
}

TEST(NestedElements, CornersOfSplitCellsAreNodes) {
  const NestedElements elements = three_levels();
  for (std::size_t k = 0; k + 1 < 3; ++k) {
    const ElementLevel& level = elements.levels()[k];
    std::vector<char> is_node(level.points.size(), 0);
    for (const int point : level.point_of_node) is_node[static_cast<std::size_t>(point)] = 1;
    for (std::size_t c = 0; c < level.cells.size(); ++c) {
      if (level.first_part[c] == no_leaf) continue;
      for (const int corner : level.corners[c]) EXPECT_TRUE(is_node[static_cast<std::size_t>(corner)]);
    }
  }
}

TEST(NestedElements, ValuesAndRestrictionAreTransposes) {
  const NestedElements elements = three_levels();
  const Points coefficients = random_coefficients(elements, 1);
  const std::vector<Points> values = elements.values(coefficients);
  std::vector<Points> weights;
  double expected = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    weights.push_back(test::random_points(values[k].cols(), 7 + static_cast<unsigned>(k)));
    expected += product(values[k], weights[k]);
  }
  EXPECT_NEAR(product(coefficients, elements.restricted(weights)), expected, 1e-10);
}

TEST(NestedElements, AreWhatThePyramidHolds) {
  const NestedElements elements = three_levels();
  const Points coefficients = random_coefficients(elements, 2);
  const Matrix3 linear = test::random_rotation(3) * 2;
  const BakedMap map({}, pyramid_of(elements, coefficients, linear));
  const std::vector<Points> values = elements.values(coefficients);
  const Points x = (test::random_points(500, 4) * 1.4).colwise() + Vector3(0.1, 0.2, 0.3);
  const Points found = map.displacement(x);
  int inside = 0;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const std::vector<ElementPlace> places = elements.places(x.col(i));
    Vector3 expected = Vector3::Zero();
    if (!places.empty())
      for (std::size_t corner = 0; corner < 8; ++corner)
        expected += places.back().weights[corner] *
                    values[static_cast<std::size_t>(places.back().level)].col(places.back().corners[corner]);
    inside += !places.empty();
    EXPECT_NEAR((found.col(i) - linear * expected).norm(), 0, 2e-6);  // stored as floats
  }
  EXPECT_GT(inside, 300);
}

TEST(NestedElements, RefiningKeepsTheMap) {
  const NestedElements elements = three_levels();
  const Points coefficients = random_coefficients(elements, 5);
  std::vector<std::vector<LatticeCoordinates>> nodes;
  for (const ElementLevel& level : elements.levels()) nodes.push_back(level.nodes);
  nodes.push_back({{5, 5, 5}, {-9, 2, 3}});
  const NestedElements finer(elements.lattice(0), nodes);
  const BakedMap before({}, pyramid_of(elements, coefficients, Matrix3::Identity()));
  const BakedMap after({},
                       pyramid_of(finer, transferred(elements, coefficients, finer), Matrix3::Identity()));
  const Points x = test::random_points(500, 6) * 2;
  EXPECT_LT((before.displacement(x) - after.displacement(x)).cwiseAbs().maxCoeff(), 1e-6);
}

}  // namespace
}  // namespace bespoke
