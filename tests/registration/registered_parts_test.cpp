#include "bespoke/registration/registered_parts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "bespoke/pipeline/fit_mapping.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TriangleMesh ball(double radius, const Vector3& center, int levels = 2) {
  return shapes::moved(shapes::icosphere(levels), {radius * Matrix3::Identity(), center});
}

/// A body with markers of joints within it and a garment around it, and a target that has the body alone.
struct Avatar {
  TriangleMesh body = shapes::icosphere(3);
  TriangleMesh source = body;
  TriangleMesh target = shapes::moved(shapes::icosphere(4), {1.2 * Matrix3::Identity(), {3, 1, 2}});
  Anchors anchors;
  int parts = 1;

  Avatar() {
    for (const Vector3& joint : {Vector3(0, 0, 0.3), Vector3(0.2, 0, -0.3), Vector3(0, 0.4, 0)}) add(joint);
    TriangleMesh garment = ball(1.15, {0, 0, 0});
    std::vector<Eigen::Index> kept;
    for (Eigen::Index face = 0; face < garment.faces.cols(); ++face)
      if (garment.vertices(2, garment.faces(0, face)) < 0) kept.push_back(face);
    garment.faces = garment.faces(Eigen::all, kept).eval();
    source = shapes::joined(source, garment);
    ++parts;
    const Points corners = shapes::icosphere(0).vertices;
    for (Eigen::Index i = 0; i < corners.cols(); ++i)
      anchors.pairs.push_back({"", corners.col(i), 1.2 * corners.col(i) + Vector3(3, 1, 2)});
  }

  void add(const Vector3& joint) {
    source = shapes::joined(source, shapes::moved(shapes::cube(0.05), {Matrix3::Identity(), joint}));
    ++parts;
  }

  FittedMapping fit(const TriangleMesh& model) const {
    FitOptions options;
    options.lambda = 0.4;
    options.elastic = ElasticMethod::csrbf;
    return fit_mapping({model, target, anchors}, options);
  }
};

TEST(RegisteredParts, AreTheBodyWithTheAnchorsAlone) {
  const Avatar avatar;
  const RegisteredParts parts = parts_to_register(avatar.source, avatar.target, avatar.anchors);
  EXPECT_EQ(parts.components.count(), avatar.parts);
  EXPECT_THAT(parts.is_kept, ElementsAre(1, 0, 0, 0, 0));
  EXPECT_EQ(parts.mesh(avatar.source).mesh.faces, avatar.body.faces);
  EXPECT_EQ(parts_to_register(avatar.source, avatar.target, {}).is_kept, parts.is_kept);
}

TEST(RegisteredParts, AreAllWhereTheTargetHasAsMany) {
  const Avatar avatar;
  EXPECT_TRUE(parts_to_register(avatar.source, avatar.source, avatar.anchors).is_whole());
  EXPECT_TRUE(parts_to_register(avatar.body, avatar.target, avatar.anchors).is_whole());
}

TEST(RegisteredParts, AreThoseThatAnAnchorLiesOn) {
  Avatar avatar;
  avatar.anchors.pairs.push_back({"hem", {0, 0, -1.15}, {3, 1, 0.8}});
  EXPECT_THAT(parts_to_register(avatar.source, avatar.target, avatar.anchors).is_kept,
              ElementsAre(1, 0, 0, 0, 1));
}

TEST(RegisteredParts, AreAllWithoutAnchorsWhereNoneIsTheBody) {
  const TriangleMesh two = shapes::joined(ball(1, {0, 0, 0}), ball(1, {4, 0, 0}));
  EXPECT_TRUE(parts_to_register(two, ball(2, {0, 0, 0}), {}).is_whole());
}

TEST(RegisteredParts, GainWhatLiesWhereTheTargetIsUncovered) {
  // The source in two pieces that do not share a vertex; the target as one file has both, with a bridge that
  // makes one component of them.
  const TriangleMesh torso = ball(1, {0, 0, 0}, 3), head = ball(0.5, {0, 0, 2}, 3);
  const TriangleMesh source =
      shapes::joined(shapes::joined(torso, head), shapes::moved(shapes::cube(0.1), {}));
  TriangleMesh target = shapes::joined(torso, head);
  target.faces.conservativeResize(3, target.faces.cols() + 1);
  target.faces.rightCols(1) << 0, 1, static_cast<int>(torso.vertices.cols());
  Anchors anchors;
  for (Eigen::Index i = 0; i < 12; ++i)
    anchors.pairs.push_back({"", torso.vertices.col(i), torso.vertices.col(i)});
  RegisteredParts parts = parts_to_register(source, target, anchors);
  EXPECT_THAT(parts.is_kept, ElementsAre(1, 0, 0));
  EXPECT_TRUE(keep_uncovered(parts, source, target, torso.vertices));
  EXPECT_THAT(parts.is_kept, ElementsAre(1, 1, 0));
  EXPECT_FALSE(keep_uncovered(parts, source, target, shapes::joined(torso, head).vertices));
}

TEST(FitMapping, OfASourceWithLoosePartsIsThatOfItsBody) {
  const Avatar avatar;
  const FittedMapping alone = avatar.fit(avatar.body), whole = avatar.fit(avatar.source);
  ASSERT_TRUE(whole.summary.parts);
  EXPECT_EQ(whole.summary.parts->parts, avatar.parts);
  EXPECT_EQ(whole.summary.parts->loose.size(), 4u);
  EXPECT_FALSE(alone.summary.parts);
  EXPECT_EQ((*whole.elastic)(avatar.source.vertices), (*alone.elastic)(avatar.source.vertices));

  const Eigen::Index body = avatar.body.vertices.cols(), all = avatar.source.vertices.cols();
  ASSERT_EQ(whole.fitted_vertices.cols(), all);
  EXPECT_EQ(whole.fitted_vertices.leftCols(body), alone.fitted_vertices);
  EXPECT_LT((whole.fitted_vertices - (*whole.elastic)(avatar.source.vertices)).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_EQ(whole.step_sources.front(), avatar.source.vertices);
  ASSERT_EQ(whole.confidence.size(), static_cast<std::size_t>(all));
  EXPECT_EQ(whole.confidence.back(), 0);
}

TEST(FitMapping, OfModelsTakenAsGivenRegistersAllParts) {
  Avatar avatar;
  FitOptions options;
  options.lambda = 0.4;
  options.elastic = ElasticMethod::csrbf;
  options.surface_fit.repair_models = false;
  const FittedMapping fit = fit_mapping({avatar.source, avatar.target, avatar.anchors}, options);
  EXPECT_FALSE(fit.summary.parts);
  EXPECT_EQ(fit.fitted_vertices.cols(), avatar.source.vertices.cols());
}

TEST(LooseParts, AreNamedTheLargestGroupFirst) {
  LoosePartsSummary summary{4, {{1, 10, 8, 12, "joint"}, {2, 18, 8, 12, "joint"}, {3, 26, 100, 50, ""}}};
  EXPECT_THAT(to_string(summary), HasSubstr("3 of 4 parts of the source have no counterpart"));
  EXPECT_THAT(to_string(summary), HasSubstr(": part 4 (100 vertices), \"joint\" (16 vertices)"));
}

}  // namespace
}  // namespace bespoke
