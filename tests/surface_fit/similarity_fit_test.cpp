#include "bespoke/surface_fit/graph/similarity_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/potato.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using shapes::potato;

TEST(FitSimilarity, FindsTheSimilarityOfACopyWithOtherConnectivity) {
  const Similarity truth{1.2, test::random_rotation(3), Vector3(1, 2, 3)};
  TriangleMesh copy = potato(5);
  copy.vertices = truth * copy.vertices;
  Similarity start = truth;
  start.scale *= 1.03;
  start.rotation = Eigen::AngleAxisd(0.05, Vector3::UnitY()) * start.rotation;
  SimilaritySettings settings;
  settings.tolerance = 1.5e-3;  // the sag of the coarser facets
  const SimilarityFit fit = fit_similarity(potato(3), TargetSurface(copy), start, settings);
  EXPECT_TRUE(fit.suffices);
  EXPECT_NEAR(fit.target_from_source.scale, truth.scale, 3e-3);
  EXPECT_LT((fit.target_from_source.rotation - truth.rotation).norm(), 5e-3);
}

TEST(FitSimilarity, KnowsWhenNoneSuffices) {
  TriangleMesh stretched = potato(4);
  stretched.vertices.row(2) *= 1.3;
  EXPECT_FALSE(fit_similarity(potato(3), TargetSurface(stretched), Similarity{}).suffices);
  const TriangleMesh far = shapes::moved(potato(3), {Matrix3::Identity(), Vector3(50, 0, 0)});
  EXPECT_FALSE(fit_similarity(potato(3), TargetSurface(far), Similarity{}).suffices);
}

/// Moved along its normals, mesh units.
TriangleMesh displaced(TriangleMesh mesh, const Eigen::VectorXd& offsets) {
  mesh.vertices += vertex_normals(mesh) * offsets.asDiagonal();
  return mesh;
}

TEST(FitSimilarity, SufficesForANoisyCopyAndNotForOneWithRelief) {
  const TriangleMesh source = shapes::of_unit_diagonal(potato(5)), fine = shapes::of_unit_diagonal(potato(5));
  const Eigen::Index count = fine.vertices.cols();
  constexpr double height = 7e-4;  // the tolerance is 5e-4
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, height);
  Eigen::VectorXd rough(count), relief(count), swollen(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    rough[i] = noise(random);
    relief[i] = 1.4 * height * std::sin(60 * fine.vertices(0, i));  // waves of a tenth of the diagonal
    swollen[i] = 1.4 * height * std::sin(12 * fine.vertices(0, i));
  }
  const auto fitted = [&](const Eigen::VectorXd& offsets) {
    return fit_similarity(source, TargetSurface(displaced(fine, offsets)), Similarity{});
  };
  const SimilarityFit noisy = fitted(rough);
  EXPECT_GT(noisy.residual, SimilaritySettings{}.tolerance);
  EXPECT_TRUE(noisy.suffices);
  EXPECT_NEAR(noisy.target_from_source.scale, 1, 1e-3);
  EXPECT_FALSE(fitted(relief).suffices);
  EXPECT_FALSE(fitted(swollen).suffices);
}

}  // namespace
}  // namespace bespoke
