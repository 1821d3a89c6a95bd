#include "bespoke/surface_fit/detail/detail_layers.h"

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace bespoke {
namespace {

TriangleMesh wavy(int levels) {
  TriangleMesh mesh = shapes::icosphere(levels);
  for (auto&& x : mesh.vertices.colwise()) x *= 1 + 0.01 * std::sin(9 * x[0]) * std::cos(7 * x[1]);
  return mesh;
}

TEST(FitDetails, BringsASurfaceOntoAWavyOneWithoutFolds) {
  const TriangleMesh sphere = shapes::icosphere(4);
  const TargetSurface target(wavy(5));
  const Points none(3, 0);
  const DetailFit fit = fit_details({sphere, target, none, none}, {}, {});
  for (const auto& x : fit.vertices.colwise()) EXPECT_LT(std::sqrt(target.closest(x).squared_distance), 2e-4);
  const Points before = face_normals(sphere), after = face_normals({fit.vertices, sphere.faces});
  EXPECT_GT((before.cwiseProduct(after)).colwise().sum().minCoeff(), 0.7);
}

TEST(FitDetails, CarriesExactAnchorsOntoTheirTargets) {
  const TriangleMesh sphere = shapes::icosphere(4);
  const TargetSurface target(wavy(5));
  const Points from = sphere.vertices.leftCols(3);
  Points to(3, 3);
  for (int k = 0; k < 3; ++k) {
    const Vector3 x = from.col(k);
    to.col(k) = x * (1 + 0.01 * std::sin(9 * x[0]) * std::cos(7 * x[1]));
  }
  const DetailFit fit = fit_details({sphere, target, from, to}, {}, {});
  EXPECT_LT((fit.anchor_sources - to).colwise().norm().maxCoeff(), 1e-4);
  EXPECT_LT((fit.vertices.leftCols(3) - to).colwise().norm().maxCoeff(), 1e-4);
}

TEST(MeetAnchors, MovesAnchorsOntoTheirTargetsAndNothingFarAway) {
  const TriangleMesh sphere = shapes::icosphere(4);
  const TargetSurface target(sphere);
  const Points from = sphere.vertices.leftCols(1), to = 1.001 * from;
  const DetailFit fit = meet_anchors({sphere, target, from, to});
  EXPECT_LT((fit.anchor_sources - to).norm(), 2e-3 * 1e-3);
  for (Eigen::Index i = 0; i < sphere.vertices.cols(); ++i) {
    if ((sphere.vertices.col(i) - from.col(0)).norm() > 0.03) {
      EXPECT_EQ(fit.vertices.col(i), sphere.vertices.col(i));
    }
  }
}

}  // namespace
}  // namespace bespoke
