#include "bespoke/alignment/align_models.h"

#include <gmock/gmock.h>

#include <cmath>

#include "bespoke/error.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using ::testing::HasSubstr;

/// A ball with three limbs of different lengths where no rotation or reflection takes one to another.
Vector3 on_bumpy_ball(const Vector3& direction) {
  const auto bump = [&](const Vector3& center, double height, double width) {
    return height * std::exp((direction.dot(center.normalized()) - 1) / (width * width));
  };
  const double radius =
      1 + bump({1, 0.2, 0.1}, 2.4, 0.4) + bump({-0.3, 1, 0}, 1.4, 0.3) + bump({0.1, -0.4, 1}, 0.7, 0.5);
  return radius * direction;
}

/// Meshed differently for every `turn`, but the same surface.
TriangleMesh bumpy_ball(double turn) {
  const Matrix3 rotation = Eigen::AngleAxisd(turn, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  TriangleMesh mesh = shapes::icosphere(3);
  for (auto&& vertex : mesh.vertices.colwise()) vertex = on_bumpy_ball((rotation * vertex).normalized());
  return mesh;
}

TriangleMesh mirror_image(TriangleMesh mesh) {
  mesh.vertices.row(0) *= -1;
  mesh.faces.row(0).swap(mesh.faces.row(1));
  return mesh;
}

TEST(AlignModels, RecoversASimilarityFromAnyRotation) {
  const TriangleMesh source = bumpy_ball(0), same_surface = bumpy_ball(0.7);
  for (const double angle : {0.5, 2.0, 3.1}) {
    Similarity truth;
    truth.scale = 25.4;
    truth.rotation = Eigen::AngleAxisd(angle, Vector3(-1, angle, 2).normalized()).toRotationMatrix();
    truth.translation = Vector3(100, -20, 3);
    const TriangleMesh target{truth * same_surface.vertices, same_surface.faces};

    const Alignment alignment = align_models(source, target);
    EXPECT_EQ(alignment.summary.verdict, AlignmentVerdict::certain) << to_string(alignment.summary);
    EXPECT_NO_THROW(require_certain(alignment.summary));
    const Points expected = truth * source.vertices, found = alignment.target_from_source * source.vertices;
    EXPECT_NEAR(alignment.target_from_source.rotation.determinant(), 1, 1e-12);
    EXPECT_LT((found - expected).colwise().norm().maxCoeff(), 0.03 * diagonal(target.vertices));
    EXPECT_LT((alignment.deformed - expected).colwise().norm().maxCoeff(), 0.05 * diagonal(target.vertices));
  }
}

TEST(AlignModels, DecidesTheSameWhateverThePositionOfTheTarget) {
  const TriangleMesh source = bumpy_ball(0), same_surface = bumpy_ball(0.7);
  const AlignmentSummary here = align_models(source, same_surface).summary;
  Similarity elsewhere;
  elsewhere.scale = 0.125;
  elsewhere.rotation = Eigen::AngleAxisd(2.2, Vector3(3, -1, 2).normalized()).toRotationMatrix();
  elsewhere.translation = Vector3(-7, 0, 40);
  const AlignmentSummary there =
      align_models(source, {elsewhere * same_surface.vertices, same_surface.faces}).summary;
  EXPECT_EQ(there.verdict, here.verdict);
  EXPECT_NEAR(there.misfit, here.misfit, 1e-3 * here.misfit);
  EXPECT_NEAR(there.scale, elsewhere.scale * here.scale, 1e-3 * there.scale);
}

TEST(AlignModels, RefusesUnrelatedModels) {
  TriangleMesh bar = shapes::icosphere(3);
  bar.vertices = Vector3(6, 1, 0.3).asDiagonal() * bar.vertices;
  const Alignment alignment = align_models(bumpy_ball(0), bar);
  EXPECT_NE(alignment.summary.verdict, AlignmentVerdict::certain) << to_string(alignment.summary);
}

TEST(AlignModels, RefusesAMirrorImage) {
  const Alignment alignment = align_models(bumpy_ball(0), mirror_image(bumpy_ball(0.7)));
  EXPECT_NE(alignment.summary.verdict, AlignmentVerdict::certain) << to_string(alignment.summary);
  ASSERT_TRUE(alignment.summary.mirror_misfit.has_value());
  EXPECT_LT(*alignment.summary.mirror_misfit, alignment.summary.misfit);
  EXPECT_THROW(require_certain(alignment.summary), SolverError);
}

TEST(AlignModels, RefusesABall) {
  const Alignment alignment = align_models(shapes::icosphere(3), shapes::icosphere(2));
  EXPECT_EQ(alignment.summary.verdict, AlignmentVerdict::ambiguous) << to_string(alignment.summary);
  try {
    require_certain(alignment.summary);
    FAIL() << "a ball was aligned";
  } catch (const SolverError& error) {
    EXPECT_THAT(error.what(), HasSubstr("at least 4 anchors"));
  }
}

TEST(AlignModels, RefusesAModelTurnedInsideOut) {
  TriangleMesh inside_out = bumpy_ball(0.7);
  inside_out.faces.row(0).swap(inside_out.faces.row(1));
  const Alignment alignment = align_models(bumpy_ball(0), inside_out);
  EXPECT_NE(alignment.summary.verdict, AlignmentVerdict::certain) << to_string(alignment.summary);
}

TEST(AlignModels, KnowsSymmetricShapes) {
  TriangleMesh egg = shapes::icosphere(3);
  egg.vertices = Vector3(1, 1.5, 2).asDiagonal() * egg.vertices;
  EXPECT_LT(align_models(egg, egg).summary.asymmetry, 0.02);
  EXPECT_GT(align_models(bumpy_ball(0), bumpy_ball(0)).summary.asymmetry, 0.02);
}

TEST(AlignModels, RejectsAnEmptyMesh) {
  EXPECT_THROW(align_models(TriangleMesh{}, shapes::cube()), InvalidInput);
  EXPECT_THROW(align_models(shapes::cube(), TriangleMesh{}), InvalidInput);
}

TEST(AlignModels, StopsWhenCancelled) {
  Progress progress;
  progress.cancelled = [] { return true; };
  EXPECT_THROW(align_models(shapes::cube(), shapes::cube(), progress), Interrupted);
}

}  // namespace
}  // namespace bespoke
