#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "bespoke/anchors/anchor_curves.h"
#include "bespoke/error.h"
#include "bespoke/pipeline/fit_mapping.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

/// The circle of an ellipsoid of these radii at the height z of the unit sphere.
Points level_curve(const Vector3& radii, double z, int points, double begin) {
  Points curve(3, points);
  for (int i = 0; i < points; ++i) {
    const double angle = begin + 2 * std::numbers::pi * i / points;
    const double around = std::sqrt(1 - z * z);
    curve.col(i) = radii.cwiseProduct(Vector3(around * std::cos(angle), around * std::sin(angle), z));
  }
  return curve;
}

/// A sphere and an ellipsoid, with a waist line at other heights of the two: 0.1 and 0.25.
struct CurveScene {
  TriangleMesh source = shapes::icosphere(4);
  TriangleMesh target = shapes::icosphere(5);
  Anchors anchors;
  FitOptions options;

  CurveScene() {
    const Vector3 one(1, 1, 1), radii(1.1, 0.9, 1.2);
    target.vertices = radii.asDiagonal() * target.vertices;
    for (const double side : {-1.0, 1.0})
      anchors.pairs.push_back({"", side * Vector3::UnitZ(), side * radii.z() * Vector3::UnitZ()});
    anchors.pairs.push_back({"", Vector3(0.8, 0, 0.6), radii.cwiseProduct(Vector3(0.8, 0, 0.6))});
    anchors.pairs.push_back({"", Vector3(0, 0.8, -0.6), radii.cwiseProduct(Vector3(0, 0.8, -0.6))});
    for (AnchorPair& pair : anchors.pairs) pair.sigma = 0;
    anchors.curves = {{"waist", level_curve(one, 0.1, 200, 0), level_curve(radii, 0.25, 300, 1), true, {}}};
    options.lambda = 0.4;
    options.fit_tolerance = 0.002 * diagonal(source.vertices);
  }
};

TEST(FitCurves, MeetThemWithinTheTolerance) {
  CurveScene scene;
  const FittedMapping fit = fit_mapping({scene.source, scene.target, scene.anchors}, scene.options);
  ASSERT_EQ(fit.summary.curves.size(), 1u);
  EXPECT_LT(fit.summary.curves[0].largest_distance, 2 * scene.options.fit_tolerance);
  EXPECT_EQ(fit.anchor_residual.size(), scene.anchors.pairs.size());
  EXPECT_EQ(fit.anchor_sigma.size(), scene.anchors.pairs.size());

  // Without the curve the waist stays about where the ellipsoid has its own.
  Anchors pairs_only = scene.anchors;
  pairs_only.curves.clear();
  const FittedMapping plain = fit_mapping({scene.source, scene.target, pairs_only}, scene.options);
  const AnchorCurve& waist = scene.anchors.curves[0];
  const Points mapped = plain.target_from_source * (*plain.elastic)(waist.a);
  EXPECT_GT(distance_from_polyline(waist.b, true, mapped), 10 * fit.summary.curves[0].largest_distance);
}

// Its counterpart goes up and down more steeply than a surface follows without folds.
TEST(FitCurves, GiveWayWhereTheyWouldFoldTheSurface) {
  CurveScene scene;
  Points& wavy = scene.anchors.curves[0].b;
  for (Eigen::Index i = 0; i < wavy.cols(); ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(wavy.cols());
    wavy.col(i) = level_curve({1.1, 0.9, 1.2}, 0.1 + 0.1 * std::sin(12 * angle), 1, angle);
  }
  const FittedMapping fit = fit_mapping({scene.source, scene.target, scene.anchors}, scene.options);
  const TriangleMesh fitted{fit.target_from_source * fit.fitted_vertices, scene.source.faces};
  const Points normals = face_normals(fitted);
  for (Eigen::Index face = 0; face < fitted.faces.cols(); ++face)
    EXPECT_GT(normals.col(face).dot(fitted.vertices.col(fitted.faces(0, face))), 0) << face;
  EXPECT_GT(fit.summary.curves[0].largest_distance, 10 * scene.options.fit_tolerance);  // and it is said
}

TEST(FitCurves, AreRefusedWithAGivenFit) {
  CurveScene scene;
  EXPECT_THROW(fit_mapping({scene.source, scene.source, scene.anchors, &scene.source}, scene.options),
               InvalidInput);
}

}  // namespace
}  // namespace bespoke
