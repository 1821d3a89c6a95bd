#include "bespoke/anchors/size_ratio.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "support/shapes.h"

namespace bespoke {
namespace {

TriangleMesh scaled(TriangleMesh mesh, double factor) {
  mesh.vertices *= factor;
  return mesh;
}

Anchors anchors_on(const TriangleMesh& source, const TriangleMesh& target, int count) {
  Anchors anchors;
  for (int i = 0; i < count; ++i) {
    AnchorPair pair;
    pair.a = source.vertices.col(7 * i);
    pair.b = target.vertices.col(7 * i);
    anchors.pairs.push_back(pair);
  }
  return anchors;
}

TEST(SizeRatio, IsThatOfTheModels) {
  const TriangleMesh source = shapes::icosphere(2);
  for (const double factor : {0.2, 1.0, 5.0}) {
    const TriangleMesh target = scaled(source, factor);
    for (const int count : {0, 2, 12})
      EXPECT_NEAR(size_ratio(anchors_on(source, target, count), source, target), factor, 1e-12) << count;
  }
}

// A raised arm changes the box; debris of a scan does, too.
TEST(SizeRatio, IsToldByAnchorsWhereThereAreThree) {
  const TriangleMesh source = shapes::icosphere(2);
  TriangleMesh target = scaled(source, 2);
  target.vertices.col(1) *= 30;
  EXPECT_NEAR(size_ratio(anchors_on(source, scaled(source, 2), 12), source, target), 2, 1e-12);
  EXPECT_EQ(std::string(measured_by(anchors_on(source, target, 3))), "their anchors");
  EXPECT_EQ(std::string(measured_by(anchors_on(source, target, 2))), "their bounding boxes");
}

TEST(SizeRatio, IsNoneOfModelsWithoutExtent) {
  const TriangleMesh source = shapes::icosphere(2);
  const double ratio = size_ratio({}, scaled(source, 0), source);
  EXPECT_FALSE(std::isfinite(ratio));
}

}  // namespace
}  // namespace bespoke
