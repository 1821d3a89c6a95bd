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
  std::vector<ProductPattern> patterns;
  std::vector<Points> corrected;
  std::vector<std::string> notes;

  UnpackedScene scene(const ViewOptions& options = {}) const {
    return unpacked(view_scene({asset, source, target, products, findings, "map.vdb", "bespoke view map.vdb",
                                patterns, corrected, notes},
                               options));
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

/// All triangles of a mesh as one piece, its x and y in place of a flattening.
WrittenPattern shadow_of(const TriangleMesh& mesh) {
  WrittenPiece piece{"shadow", mesh.vertices, mesh.faces, {0, 1, 2}, {}, {}};
  piece.places.row(2).setZero();
  for (int f = 0; f < mesh.faces.cols(); ++f) {
    piece.product_faces.push_back(f);
    piece.strain.push_back(0.001 * f);
  }
  return {"pieces.json", {piece}};
}

TEST(ViewScene, HasThePiecesOfItsProductsWhichStayWhole) {
  Scenery scenery;
  EXPECT_EQ(scenery.scene().record["patterns"], nlohmann::json::array());
  scenery.products.push_back({"ball.obj", test::sphere(Vector3(0.2, -0.4, -0.2), 0.8, 4)});
  const TriangleMesh& ball = scenery.products[1].mesh;
  scenery.patterns = {{1, shadow_of(ball)}};
  const UnpackedScene scene = scenery.scene({.max_faces = 2000});
  EXPECT_TRUE(scene.record["meshes"][3]["original"].is_null());
  ASSERT_EQ(scene.record["patterns"].size(), 1u);
  EXPECT_EQ(scene.record["patterns"][0]["mesh"], 3);
  const nlohmann::json& piece = scene.record["patterns"][0]["pieces"].at(0);
  EXPECT_EQ(piece["name"], "shadow");
  EXPECT_EQ(scene.numbers(piece["outline"]), (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_EQ(scene.numbers(piece["product_faces"]).size(), static_cast<std::size_t>(ball.faces.cols()));
  EXPECT_LT((scene.points(piece["places"]) - scenery.patterns[0].pattern.pieces[0].places)
                .colwise()
                .norm()
                .maxCoeff(),
            1e-4);
}

TEST(ViewScene, EndsWhereProductsAreCorrected) {
  Scenery scenery;
  const auto ids = [](const UnpackedScene& scene) {
    std::set<std::string> found;
    for (const nlohmann::json& field : scene.record["meshes"][2]["fields"]) found.insert(field["id"]);
    return found;
  };
  EXPECT_EQ(ids(scenery.scene()).count("moved"), 0u);
  const TriangleMesh& ring = scenery.products[0].mesh;
  const Points carried = scenery.asset.target_from_source * loaded_chain(scenery.asset.steps)(ring.vertices);
  scenery.corrected = {carried.colwise() + Vector3(0.02, 0, 0)};
  scenery.notes = {"ring.obj: moved"};
  const UnpackedScene scene = scenery.scene();
  EXPECT_THAT((std::set<std::string>{"moved", "clearance_carried", "clearance_after"}),
              IsSubsetOf(ids(scene)));
  const nlohmann::json& mesh = scene.record["meshes"][2];
  const Points start = composed(scene, mesh, scenery.asset, 0), end = composed(scene, mesh, scenery.asset, 1);
  EXPECT_LT((start - ring.vertices).colwise().norm().maxCoeff(), 1e-4);
  EXPECT_LT((end - scenery.corrected[0]).colwise().norm().maxCoeff(), 1e-4);
  EXPECT_EQ(scene.record["notes"].back(), "ring.obj: moved");
  for (const nlohmann::json& field : mesh["fields"])
    if (field["id"] == "moved") {
      EXPECT_NEAR(field["values"]["min"].get<double>(), 0.02, 1e-9);
      EXPECT_NEAR(field["values"]["max"].get<double>(), 0.02, 1e-9);
    }
  scenery.corrected.push_back(carried);
  EXPECT_THROW(scenery.scene(), InvalidInput);
  scenery.corrected = {carried.leftCols(3)};
  EXPECT_THROW(scenery.scene(), InvalidInput);
}

TEST(ViewScene, RefusesPatternsOfOtherProducts) {
  Scenery scenery;
  scenery.patterns = {{1, shadow_of(scenery.products[0].mesh)}};
  EXPECT_THROW(scenery.scene(), InvalidInput);
  scenery.patterns = {{0, shadow_of(scenery.source)}};
  EXPECT_THROW(scenery.scene(), InvalidInput);
}

TEST(ViewScene, RefusesFindingsOfAnotherSource) {
  Scenery scenery;
  scenery.findings.confidence = {0.5};
  EXPECT_THROW(scenery.scene(), InvalidInput);
  EXPECT_THROW(Scenery{}.scene({.max_faces = 0}), InvalidInput);
}

}  // namespace
}  // namespace bespoke
