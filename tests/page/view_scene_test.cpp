#include "bespoke/page/view_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "asset/small_asset.h"
#include "bespoke/apply/apply_mapping.h"
#include "bespoke/error.h"
#include "page/unpacked_scene.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using test::unpacked;
using test::UnpackedScene;
using testing::IsSubsetOf;

struct Scenery {
  Asset asset = test::small_asset();
  TriangleMesh source = test::sphere(Vector3(0.2, -0.4, -0.2), 0.6, 3);
  TriangleMesh target = test::sphere(Vector3(0.9, 0.1, 0.1), 0.6, 2);
  std::vector<NamedProduct> products{{"ring.obj", test::sphere(Vector3(0.2, -0.4, -0.2), 0.7, 2)}};
  FitFindings findings;

  UnpackedScene scene(const ViewOptions& options = {}) const {
    return unpacked(
        view_scene({asset, source, target, products, findings, "map.vdb", "bespoke view map.vdb"}, options));
  }
};

/// R(t)·((1−f) x + f y) + t T from the two knots around t, as the page computes it.
Points composed(const UnpackedScene& scene, const nlohmann::json& mesh, const Asset& asset, double t) {
  const auto knots = scene.record["motion"]["knots"].get<std::vector<double>>();
  std::size_t k = 0;
  while (k + 2 < knots.size() && t >= knots[k + 1]) ++k;
  const double f = (t - knots[k]) / (knots[k + 1] - knots[k]);
  const Points between = (1 - f) * scene.points(mesh["places"][k]) + f * scene.points(mesh["places"][k + 1]);
  const RigidTransform& rigid = asset.target_from_source;
  return (rotation_at(rigid.rotation, asset.path, t) * between).colwise() + t * rigid.translation;
}

TEST(ViewScene, HoldsWhatThePageNeedsToCarryProducts) {
  const Scenery scenery;
  const UnpackedScene scene = scenery.scene();
  const TriangleMesh& ring = scenery.products[0].mesh;
  const ElasticChain chain = loaded_chain(scenery.asset.steps);
  for (const double t : {0.0, 0.3, 1.0}) {
    const Points carried =
        apply_mapping(chain, scenery.asset.target_from_source, ring.vertices, {t}, {scenery.asset.path})
            .frames[0];
    const Points found = composed(scene, scene.record["meshes"][2], scenery.asset, t);
    EXPECT_LT((found - carried).colwise().norm().maxCoeff(), 1e-5 * diagonal(carried)) << "t = " << t;
  }
}

TEST(ViewScene, FollowsTheStepsOfAChain) {
  Scenery scenery;
  scenery.asset.steps.push_back(scenery.asset.steps.front());
  scenery.asset.path = RotationPath::flow;
  const UnpackedScene scene = scenery.scene();
  EXPECT_EQ(scene.record["motion"]["knots"], nlohmann::json({0.0, 0.5, 1.0}));
  const ElasticChain chain = loaded_chain(scenery.asset.steps);
  for (const double t : {0.25, 0.5, 0.8}) {
    const Points carried = apply_mapping(chain, scenery.asset.target_from_source, scenery.source.vertices,
                                         {t}, {RotationPath::flow})
                               .frames[0];
    const Points found = composed(scene, scene.record["meshes"][0], scenery.asset, t);
    EXPECT_LT((found - carried).colwise().norm().maxCoeff(), 1e-5 * diagonal(carried)) << "t = " << t;
  }
}

TEST(ViewScene, ThinsMeshesToTheTrianglesAllowed) {
  Scenery scenery;
  scenery.source = test::sphere(Vector3(0.2, -0.4, -0.2), 0.6, 5);
  const UnpackedScene scene = scenery.scene({.max_faces = 4000});
  const nlohmann::json& source = scene.record["meshes"][0];
  EXPECT_EQ(source["faces_in_file"], 20480);
  EXPECT_LE(source["faces"]["count"].get<int>() / 3, 4000);
  EXPECT_FALSE(source["original"].is_null());
  const std::vector<std::uint32_t> original = scene.numbers(source["original"]);
  const Points shown = scene.points(source["places"][0]);
  for (std::size_t i = 0; i < original.size(); ++i)
    EXPECT_LT((shown.col(static_cast<Eigen::Index>(i)) - scenery.source.vertices.col(original[i])).norm(),
              1e-4);
}

TEST(ViewScene, HasLengthsInMeshUnitsWhereNoUnitIsStated) {
  Scenery scenery;
  scenery.asset.record.unit = "unknown";
  const UnpackedScene scene = scenery.scene();
  EXPECT_EQ(scene.record["unit"], "mesh units");
  for (const nlohmann::json& field : scene.record["meshes"][0]["fields"]) {
    if (field["id"] == "displacement") {
      EXPECT_EQ(field["unit"], "mesh units");
    }
  }
}

TEST(ViewScene, ColoursBySourceTargetProductAndFindings) {
  Scenery scenery;
  const auto ids = [](const nlohmann::json& mesh) {
    std::set<std::string> found;
    for (const nlohmann::json& field : mesh["fields"]) found.insert(field["id"]);
    return found;
  };
  const UnpackedScene plain = scenery.scene();
  EXPECT_EQ(ids(plain.record["meshes"][0]).count("confidence"), 0u);
  scenery.findings.confidence.assign(static_cast<std::size_t>(scenery.source.vertices.cols()), 0.5);
  scenery.findings.unmet = {{0, 0.25, "steep"}};
  const UnpackedScene scene = scenery.scene();
  EXPECT_THAT(
      (std::set<std::string>{"target_distance", "displacement", "confidence", "unmet", "determinant"}),
      IsSubsetOf(ids(scene.record["meshes"][0])));
  EXPECT_THAT((std::set<std::string>{"clearance_before", "clearance_after", "clearance_change", "area"}),
              IsSubsetOf(ids(scene.record["meshes"][2])));
  EXPECT_EQ(scene.record["unit"], "dm");
  EXPECT_EQ(scene.record["anchors"].size(), 2u);
  EXPECT_EQ(scene.record["levels"].size(), 2u);
  EXPECT_TRUE(scene.record["quality"].contains("hausdorff"));
}

TEST(ViewScene, RefusesFindingsOfAnotherSource) {
  Scenery scenery;
  scenery.findings.confidence = {0.5};
  EXPECT_THROW(scenery.scene(), InvalidInput);
  EXPECT_THROW(Scenery{}.scene({.max_faces = 0}), InvalidInput);
}

}  // namespace
}  // namespace bespoke
