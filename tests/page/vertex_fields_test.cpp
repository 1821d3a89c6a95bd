#include "bespoke/page/detail/vertex_fields.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "bespoke/lattice/baked_map.h"
#include "bespoke/mapping/elastic_chain.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

std::map<std::string, std::vector<double>> by_id(const std::vector<VertexField>& fields) {
  std::map<std::string, std::vector<double>> found;
  for (const VertexField& field : fields) found[field.id] = field.values;
  return found;
}

/// Twice as long, a third wider, half as high.
BakedMap stretched() {
  AffineMap affine;
  affine.linear = Vector3(2, 4.0 / 3, 0.5).asDiagonal();
  return BakedMap(affine, Pyramid{});
}

TEST(DeformationFields, AreThoseOfAnAffineMapOnTheSurface) {
  Points x(3, 3), normals(3, 3);
  x << 1, 0, 0, 0, 1, 0, 0, 0, 1;
  normals << 1, 0, 0, 0, 1, 0, 0, 0, 1;
  const auto fields = by_id(deformation_fields(stretched(), x, normals));
  const std::vector<double> largest{4.0 / 3, 2, 2}, smallest{0.5, 0.5, 4.0 / 3};
  for (std::size_t v = 0; v < 3; ++v) {
    EXPECT_NEAR(fields.at("largest_stretch")[v], largest[v], 1e-12);
    EXPECT_NEAR(fields.at("smallest_stretch")[v], smallest[v], 1e-12);
    EXPECT_NEAR(fields.at("area")[v], largest[v] * smallest[v], 1e-12);
    EXPECT_NEAR(fields.at("determinant")[v], 4.0 / 3, 1e-12);
  }
  EXPECT_NEAR(fields.at("displacement")[0], 1, 1e-12);
  EXPECT_NEAR(fields.at("displacement")[2], 0.5, 1e-12);
}

TEST(DeformationFields, OfPointsAreThoseOfSpaceWithoutArea) {
  const auto fields = by_id(deformation_fields(stretched(), Points::Ones(3, 1), Points::Zero(3, 1)));
  EXPECT_NEAR(fields.at("largest_stretch")[0], 2, 1e-12);
  EXPECT_NEAR(fields.at("smallest_stretch")[0], 0.5, 1e-12);
  EXPECT_TRUE(std::isnan(fields.at("area")[0]));
}

TEST(ClearanceFields, SayHowMuchFartherOffAPointLies) {
  const TriangleMesh small = shapes::cube(2), large = shapes::cube(4);
  const Points before = Vector3(1, 1, 2.5), after = Vector3(2, 2, 4.25);
  const auto fields = by_id(clearance_fields(SignedDistance(small), SignedDistance(large), before, after));
  EXPECT_NEAR(fields.at("clearance_before")[0], 0.5, 1e-12);
  EXPECT_NEAR(fields.at("clearance_after")[0], 0.25, 1e-12);
  EXPECT_NEAR(fields.at("clearance_change")[0], -0.25, 1e-12);
}

TEST(ClearanceFields, AreNotKnownBeyondABoundary) {
  const TriangleMesh sheet = shapes::square_grid(2);
  const Points beside = Vector3(2, 0.5, 0.1);
  const auto fields = by_id(clearance_fields(SignedDistance(sheet), SignedDistance(sheet), beside, beside));
  EXPECT_TRUE(std::isnan(fields.at("clearance_before")[0]));
  EXPECT_TRUE(std::isnan(fields.at("clearance_change")[0]));
}

TEST(DistanceField, HasNoSide) {
  const SignedDistance cube{shapes::cube(2)};
  EXPECT_NEAR(distance_field("d", "distance", cube, Vector3(1, 1, 1.75)).values[0], 0.25, 1e-12);
}

}  // namespace
}  // namespace bespoke
