#include "bespoke/registration/anchor_suggestions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "bespoke/mesh/closest_point.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

/// An ellipsoid of three different radii and another one, with anchors at the upper end only.
struct Scene {
  TriangleMesh source = shapes::icosphere(4);
  TriangleMesh target = shapes::icosphere(3);
  Anchors anchors;

  Scene() {
    const Vector3 a(1, 1.3, 2), b(1.2, 1.4, 1.8);
    source.vertices = a.asDiagonal() * source.vertices;
    target.vertices = b.asDiagonal() * target.vertices;
    for (const Vector3& x : {Vector3(0, 0, 1), Vector3(0.6, 0, 0.8), Vector3(0, 0.6, 0.8),
                             Vector3(-0.6, 0, 0.8), Vector3(0, -0.6, 0.8)}) {
      AnchorPair pair{std::to_string(anchors.pairs.size()), a.cwiseProduct(x), b.cwiseProduct(x)};
      pair.sigma = 0;
      anchors.pairs.push_back(pair);
    }
  }
};

TEST(AnchorSuggestions, LieOnBothSurfacesAndApart) {
  const Scene scene;
  const std::vector<SuggestedAnchor> found =
      suggest_anchors(scene.source, scene.target, scene.anchors, {4, 1e-6});
  ASSERT_EQ(found.size(), 4u);
  const ClosestPointTree source(scene.source), target(scene.target);
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(source.closest(found[i].pair.a)->squared_distance, 0);
    EXPECT_LT(target.closest(found[i].pair.b)->squared_distance, 1e-20);
    EXPECT_GT(*found[i].pair.sigma, 0);
    EXPECT_GE(found[i].confidence, 0);
    EXPECT_LE(found[i].confidence, 1);
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_GE(found[j].uncertainty, 0.5 * found[i].uncertainty);
      EXPECT_GT((found[i].pair.a - found[j].pair.a).norm(), 0.05 * diagonal(scene.source.vertices));
    }
  }
}

TEST(AnchorSuggestions, EndWhereTheFitsAreSure) {
  const Scene scene;
  Anchors onto_itself = scene.anchors;
  for (AnchorPair& pair : onto_itself.pairs) pair.b = pair.a;
  EXPECT_TRUE(suggest_anchors(scene.source, scene.source, onto_itself, {4, 1e-6}).empty());
  EXPECT_TRUE(suggest_anchors(scene.source, scene.target, scene.anchors, {4, 10}).empty());
}

TEST(AnchorSuggestions, KeepNamesApart) {
  Scene scene;
  scene.anchors.pairs[1].name = "suggested_1";
  const std::vector<SuggestedAnchor> found =
      suggest_anchors(scene.source, scene.target, scene.anchors, {1, 1e-6});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].pair.name, "suggested_2");
}

TEST(AnchorSuggestions, NeedATolerance) {
  const Scene scene;
  EXPECT_THROW(suggest_anchors(scene.source, scene.target, scene.anchors, {4, 0}), InvalidInput);
}

}  // namespace
}  // namespace bespoke
