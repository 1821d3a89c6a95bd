#include "bespoke/apply/detail/refine_product.h"
#include "apply/motions.h"

#include <gmock/gmock.h>

#include <cmath>
#include <map>

#include "support/error_message.h"

namespace bespoke {
namespace {

using test::bend;

using ::testing::HasSubstr;

/// Four triangles around (1, 1, 0) that fill the square from 0 to 3, their texture coordinates x and y.
Product fan() {
  Product product;
  product.vertices.resize(3, 5);
  product.vertices << 0, 3, 3, 0, 1,  //
      0, 0, 3, 3, 1,                  //
      0, 0, 0, 0, 0;
  product.polygon_start = {0};
  for (int k = 0; k < 4; ++k) {
    product.corners.insert(product.corners.end(), {k, (k + 1) % 4, 4});
    product.polygon_start.push_back(3 * k + 3);
  }
  product.texture.resize(2, 12);
  for (Eigen::Index i = 0; i < 12; ++i)
    product.texture.col(i) = product.vertices.col(product.corners[static_cast<std::size_t>(i)]).head<2>();
  return product;
}

double area(const Product& product) {
  const Faces faces = triangulated(product);
  double sum = 0;
  for (Eigen::Index i = 0; i < faces.cols(); ++i) {
    const Vector3 a = product.vertices.col(faces(0, i)), b = product.vertices.col(faces(1, i)),
                  c = product.vertices.col(faces(2, i));
    sum += 0.5 * (b - a).cross(c - a)[2];  // negative where a face is flipped
  }
  return sum;
}

/// Length of the edges that one polygon has alone.
double boundary(const Product& product) {
  std::map<std::pair<int, int>, int> uses;
  for (std::size_t p = 0; p + 1 < product.polygon_start.size(); ++p)
    for (int k = product.polygon_start[p]; k < product.polygon_start[p + 1]; ++k) {
      const int next = k + 1 < product.polygon_start[p + 1] ? k + 1 : product.polygon_start[p];
      const int a = product.corners[static_cast<std::size_t>(k)],
                b = product.corners[static_cast<std::size_t>(next)];
      ++uses[{std::min(a, b), std::max(a, b)}];
    }
  double sum = 0;
  for (const auto& [edge, count] : uses) {
    EXPECT_LE(count, 2);
    if (count == 1) sum += (product.vertices.col(edge.first) - product.vertices.col(edge.second)).norm();
  }
  return sum;
}

TEST(RefineProduct, MeetsTheChordErrorAndLeavesNoGaps) {
  EXPECT_DOUBLE_EQ(worst_chord(fan(), bend).length, 9.0 / 8);
  for (const double length : {0.5, 0.1, 0.01}) {
    const RefinedProduct refined = refine_product(fan(), bend, length);
    EXPECT_LE(refined.chord.length, length);
    EXPECT_GT(refined.chord.length, length / 5);  // a round divides it by four
    EXPECT_EQ(refined.product.vertices.cols(), 5 + static_cast<Eigen::Index>(refined.splits.vertices.size()));
    EXPECT_EQ(refined.product.vertices.leftCols(5), fan().vertices);
    EXPECT_NEAR(area(refined.product), 9, 1e-12);
    EXPECT_NEAR(boundary(refined.product), 12, 1e-12);
    for (Eigen::Index i = 0; i < refined.product.texture.cols(); ++i)
      EXPECT_EQ(refined.product.texture.col(i),
                refined.product.vertices.col(refined.product.corners[static_cast<std::size_t>(i)]).head<2>());
  }
}

// Edges that are short where the map bends most must not leave long ones behind: a strip of collinear points
// and of needles, where a triangle's longest edge bends least.
TEST(RefineProduct, EndsOnNeedlesAndFlatTriangles) {
  Product strip;
  strip.vertices.resize(3, 30);
  for (Eigen::Index i = 0; i < 30; ++i)
    strip.vertices.col(i) = Vector3(double(i % 7) - 3, double(i / 7) - 2, i % 2);
  strip.polygon_start = {0};
  for (int i = 0; i + 2 < 30; ++i) {
    strip.corners.insert(strip.corners.end(), {i, i + 1, i + 2});
    strip.polygon_start.push_back(3 * i + 3);
  }
  const auto wave = [](const Points& x) {
    Points y = x;
    for (Eigen::Index i = 0; i < x.cols(); ++i) y(1, i) += std::sin(3 * x(0, i)) * std::cos(2 * x(2, i));
    return y;
  };
  EXPECT_LE(refine_product(strip, wave, 0.01).chord.length, 0.01);
}

// Two triangles that share an edge by its places only, as along a seam of texture coordinates.
TEST(RefineProduct, SplitsSeamsAlike) {
  Product seam;
  seam.vertices.resize(3, 6);
  seam.vertices << 0, 0, 3, 0, 0, -1,  //
      0, 1, 0, 0, 1, 0,                //
      0, 0, 0, 0, 0, 0;
  seam.polygon_start = {0, 3, 6};
  seam.corners = {0, 2, 1, 3, 4, 5};
  // Bends the left triangle alone.
  const auto bulge = [](const Points& x) {
    Points y = x;
    y.row(2) += 10 * x.row(0).cwiseMin(0).cwiseAbs2();
    return y;
  };
  const RefinedProduct refined = refine_product(seam, bulge, 0.2);
  int on_seam = 0;
  for (Eigen::Index i = 6; i < refined.product.vertices.cols(); ++i)
    on_seam += refined.product.vertices.col(i) == Vector3(0, 0.5, 0);
  EXPECT_EQ(on_seam, 2);
}

TEST(RefineProduct, GivesPolygonsFurtherCorners) {
  Product square;
  square.vertices.resize(3, 4);
  square.vertices << 0, 4, 4, 0,  //
      0, 0, 4, 4,                 //
      0, 0, 0, 0;
  square.polygon_start = {0, 4};
  square.corners = {0, 1, 2, 3};
  const RefinedProduct refined = refine_product(square, bend, 0.6);  // edges along x of at most 2.19
  EXPECT_EQ(refined.product.corners, (std::vector<int>{0, 4, 1, 2, 5, 3}));
  EXPECT_EQ(refined.product.polygon_start, (std::vector<int>{0, 6}));
  EXPECT_EQ(refined.product.texture.cols(), 0);
}

TEST(RefineProduct, LeavesWhatStaysStraight) {
  const RefinedProduct refined = refine_product(
      fan(), [](const Points& x) -> Points { return 2 * x; }, 1e-9);
  EXPECT_TRUE(refined.splits.vertices.empty());
  EXPECT_EQ(refined.product.corners, fan().corners);
}

TEST(RefineProduct, RefusesWhatTakesTooMuch) {
  const auto refusal = [](double length, const ImageOfPoints& image) {
    return test::error_message<InvalidInput>([&] { refine_product(fan(), image, length, {}, 1000); });
  };
  EXPECT_THAT(refusal(0, bend), HasSubstr("must be positive"));
  EXPECT_THAT(refusal(1e-6, bend), HasSubstr("more than 1000 vertices"));
  // Known from the first edges, not found out by splitting.
  EXPECT_THAT(test::error_message<InvalidInput>([] { refine_product(fan(), bend, 1e-17); }),
              HasSubstr("a chord error of 1e-17 would take more than 67108864 vertices"));
  // A map that jumps is not met by any refinement.
  const auto jump = [](const Points& x) {
    Points y = x;
    for (Eigen::Index i = 0; i < x.cols(); ++i) y(2, i) = x(0, i) > 0.7 ? 1 : 0;
    return y;
  };
  EXPECT_THAT(refusal(0.1, jump), HasSubstr("allow a larger one"));
}

}  // namespace
}  // namespace bespoke
