#include "bespoke/registration/elastic_pairs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bespoke/pipeline/fit_mapping.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using ::testing::ElementsAre;

constexpr double pair_tolerance = 1e-3;

TEST(ElasticPairs, AreTheDistinctPlacesInTheirOrder) {
  TriangleMesh mesh = shapes::triangle();
  mesh.vertices.conservativeResize(3, 6);
  mesh.vertices.col(3) = mesh.vertices.col(1);  // a duplicate in a face of its own
  mesh.vertices.col(4) = Vector3(5, 5, 5);      // in no face
  mesh.vertices.col(5) = Vector3(0, 0, 1);
  mesh.faces.conservativeResize(3, 2);
  mesh.faces.col(1) << 0, 3, 5;
  Points fitted = 2 * mesh.vertices;
  fitted.col(3) += Vector3(0, 0, 1);
  const ElasticPairs pairs = elastic_pairs(mesh, fitted);
  EXPECT_THAT(pairs.referenced, ElementsAre(0, 1, 2, 3, 5));
  EXPECT_EQ(pairs.unreferenced, 1u);
  EXPECT_EQ(pairs.duplicates, 1u);
  EXPECT_EQ(pairs.sources, Points(mesh.vertices(Eigen::all, std::vector<int>{0, 1, 2, 5})));
  EXPECT_EQ(pairs.targets.col(1), Vector3((fitted.col(1) + fitted.col(3)) / 2));
  EXPECT_EQ(pairs.targets.col(3), fitted.col(5));
}

TEST(AnchorsOffSurface, AreTheExactOnesBeyondTheDistance) {
  const TriangleMesh sphere = shapes::icosphere(3);
  const Vector3 on = sphere.vertices.col(7);
  Anchors anchors;
  anchors.pairs = {{"on", on, on},
                   {"near", (1 + pair_tolerance / 2) * on, on},
                   {"off", (1 + 2 * pair_tolerance) * on, on},
                   {"inside", 0.5 * on, on},
                   {"soft", 2 * on, on, 1.0}};
  EXPECT_THAT(anchors_off_surface(sphere, anchors, pair_tolerance), ElementsAre(2, 3));
}

TEST(AnchorsOffSurface, FollowThePairsInTheSourceFrame) {
  const TriangleMesh sphere = shapes::icosphere(1);
  const RigidTransform target_from_source{test::random_rotation(1), Vector3(3, 2, 1)};
  Anchors anchors;
  anchors.pairs = {{"", Vector3(0, 0, 2), target_from_source * Vector3(0, 0, 3)}};
  const ElasticPairs pairs =
      with_anchors(elastic_pairs(sphere, sphere.vertices), anchors, {0}, inverse(target_from_source));
  EXPECT_EQ(pairs.anchors_off_surface, 1u);
  EXPECT_EQ(pairs.sources.cols(), sphere.vertices.cols() + 1);
  EXPECT_EQ(pairs.sources.rightCols(1), Points(Vector3(0, 0, 2)));
  EXPECT_LT((pairs.targets.rightCols(1) - Vector3(0, 0, 3)).norm(), 1e-14);
}

// ---- through the whole fit

/// The unit sphere onto an ellipsoid of the same connectivity; anchors at the corners of an icosahedron.
struct PairScene {
  TriangleMesh source = shapes::icosphere(3);
  TriangleMesh fitted = source;
  Anchors anchors;
  FitOptions options;

  PairScene() {
    const Vector3 radii(1.1, 1, 0.9);
    fitted.vertices = radii.asDiagonal() * source.vertices;
    const TriangleMesh icosahedron = shapes::icosphere(0);
    for (const auto& corner : icosahedron.vertices.colwise())
      anchors.pairs.push_back({"", corner, radii.asDiagonal() * Vector3(corner)});
    options.lambda = 0.5;
    options.fit_tolerance = pair_tolerance;
  }

  FittedMapping fit() const { return fit_mapping({source, fitted, anchors, &fitted}, options); }
};

TEST(FitOffSurface, AnchorsAreMetByEveryMethodThatMeetsPoints) {
  for (const ElasticMethodRow& row : elastic_methods) {
    PairScene scene;
    scene.options.elastic = row.value;
    const FittedMapping without = scene.fit();
    scene.anchors.pairs.push_back({"above", Vector3(0, 0, 1.5), Vector3(0.05, 0.1, 1.45)});
    const FittedMapping with = scene.fit();
    EXPECT_EQ(with.summary.elastic.anchors_off_surface, 1u) << row.name;
    EXPECT_EQ(with.summary.elastic.meets_anchors_off_surface, row.meets_points) << row.name;
    if (!row.meets_points) continue;
    EXPECT_EQ(without.summary.elastic.anchors_off_surface, 0u);
    const double met_within = row.met_within * pair_tolerance;
    EXPECT_LE(with.anchor_residual.back(), met_within) << row.name;
    // The surface is carried as well as before.
    EXPECT_LE(with.summary.elastic.vertex_residuals.max,
              std::max(met_within, without.summary.elastic.vertex_residuals.max))
        << row.name;
    EXPECT_TRUE(with.summary.elastic.unmet.empty()) << row.name;
  }
}

TEST(FitOffSurface, SoftAndNearAnchorsChangeNothing) {
  PairScene scene;
  const Points x = 1.5 * test::random_points(200, 3);
  // Of the rigid part they are pairs all the same: here they agree with it exactly.
  scene.fitted = scene.source;
  for (AnchorPair& pair : scene.anchors.pairs) pair.b = pair.a;
  scene.fitted.vertices.row(2) *= 1.1;
  const FittedMapping without = scene.fit();
  const Vector3 above = 1.5 * scene.source.vertices.col(40);
  const Vector3 near = (1 + pair_tolerance / 4) * scene.source.vertices.col(40);
  scene.anchors.pairs.push_back({"soft", above, above, 1e-9});
  scene.anchors.pairs.push_back({"near", near, near});
  const FittedMapping with = scene.fit();
  EXPECT_EQ(with.summary.elastic.anchors_off_surface, 0u);
  EXPECT_LT(((*with.elastic)(x) - (*without.elastic)(x)).norm(), 1e-9);
}

}  // namespace
}  // namespace bespoke
