#include <gtest/gtest.h>

#include "bespoke/length.h"
#include "bespoke/pipeline/derive_map.h"
#include "bespoke/pipeline/fit_mapping.h"
#include "bespoke/pipeline/make_map.h"
#include "flow/bent_tube.h"
#include "support/arithmetic.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using test::degree;

/// The map onto a target that is so many times as large, with default options.
MadeMap made_at(double size, const TriangleMesh& source, Points target,
                ElasticMethod method = ElasticMethod::diffeomorphic) {
  target *= size;
  const TriangleMesh fitted{std::move(target), source.faces};
  MakeMapOptions options = default_options(diagonal(source.vertices), power_of_two_scale(size));
  options.fit.any_size = true;
  options.fit.elastic = method;
  return make_map({source, fitted, {}, &fitted}, options);
}

Points images(const Asset& asset, const Points& x) {
  return asset.target_from_source * baked_chain(asset.steps)(x);
}

/// Largest distance between what the large map makes of points and what the other makes of them, so many
/// times as large; in units of the other's target.
double largest_difference(const Asset& large, const Asset& other, double size, const Points& x) {
  return (images(large, x) / size - images(other, x)).colwise().norm().maxCoeff();
}

DerivedMap inverted(const MadeMap& made) {
  return invert_map(made.asset, derived_bake({}, tolerance_of_inverse(made.asset), ValuePrecision::single));
}

/// Inside of the source's bounding box and around it.
Points points_around(const TriangleMesh& source) {
  Points x(3, 3 * source.vertices.cols());
  x << source.vertices, 0.8 * source.vertices, 1.2 * source.vertices;
  return x;
}

TriangleMesh ball() { return shapes::icosphere(3); }

Points stretched(const Points& x) {
  Points result = x;
  for (auto point : result.colwise())
    point = Vector3(1.2 * point[0], point[1] + 0.2 * point[0] * point[0], 0.9 * point[2]);
  return result;
}

TEST(ModelSizes, ScaleTheMap) {
  const TriangleMesh source = ball();
  const Points target = stretched(source.vertices);
  for (const ElasticMethod method : {ElasticMethod::diffeomorphic, ElasticMethod::multiscale}) {
    const MadeMap same = made_at(1, source, target, method);
    ASSERT_GT(voxel_count(same.asset), 0u);
    for (const double size : {1.0 / 1024, 0.5, 4.0, 1024.0}) {
      const MadeMap scaled = made_at(size, source, target, method);
      EXPECT_EQ(voxel_count(scaled.asset), voxel_count(same.asset)) << size;
      EXPECT_LT(largest_difference(scaled.asset, same.asset, size, points_around(source)), 1e-6) << size;
      EXPECT_DOUBLE_EQ(scaled.asset.record.tolerance, size * same.asset.record.tolerance);
    }
  }
}

TEST(ModelSizes, LeaveTheIterationsOfTheLaplacianFit) {
  const TriangleMesh source = ball();
  const auto registered_at = [&](double size, bool as_printed) {
    const TriangleMesh target{size * stretched(source.vertices), source.faces};
    Anchors anchors;
    for (int vertex = 0; vertex < 12; ++vertex)
      anchors.pairs.push_back({"", source.vertices.col(vertex), target.vertices.col(vertex)});
    FitOptions options = default_options(diagonal(source.vertices), power_of_two_scale(size)).fit;
    options.any_size = true;
    options.surface_fit.method = SurfaceFitMethod::laplacian;
    if (as_printed) options.surface_fit.laplacian = no_additions;
    return fit_source_surface({source, target, anchors}, options);
  };
  for (const bool as_printed : {true, false}) {
    const Registration same = registered_at(1, as_printed);
    for (const double size : {1.0 / 1024, 4.0, 1024.0}) {
      const Registration scaled = registered_at(size, as_printed);
      EXPECT_GT(same.summary.surface->iterations, 0);
      EXPECT_EQ(scaled.summary.surface->iterations, same.summary.surface->iterations) << size;
    }
  }
}

TEST(ModelSizes, ChangeNeitherTheStepsNorTheCostOfAChain) {
  const TriangleMesh source = test::tube();
  const Points bent = test::bent(source.vertices, 130 * degree);
  const MadeMap same = made_at(1, source, bent);
  ASSERT_GT(same.asset.steps.size(), 1u);
  const DerivedMap inverse_of_same = inverted(same);
  for (const double size : {0.25, 4.0}) {
    const MadeMap scaled = made_at(size, source, bent);
    EXPECT_EQ(scaled.asset.steps.size(), same.asset.steps.size()) << size;
    EXPECT_LT(voxel_count(scaled.asset), 2 * voxel_count(same.asset)) << size;
    for (const MapStep& step : scaled.asset.steps) EXPECT_TRUE(step.certificate.is_bijection()) << size;
    EXPECT_LT(largest_difference(scaled.asset, same.asset, size, source.vertices),
              2 * same.asset.record.tolerance)
        << size;
    EXPECT_DOUBLE_EQ(tolerance_of_inverse(scaled.asset).otherwise, same.asset.record.tolerance) << size;
    const DerivedMap inverse = inverted(scaled);
    EXPECT_TRUE(whole_certificate(inverse.asset).is_bijection()) << size;
    EXPECT_LT(inverse.deviation.p95, 2 * inverse_of_same.deviation.p95) << size;
  }
}

// What lies off the source lies off a larger target by as much more.
TEST(ModelSizes, TakeAnchorsOffTheSurfaceAlong) {
  const TriangleMesh source = ball();
  for (const double size : {1.0 / 1024, 1.0, 4.0, 1024.0}) {
    const TriangleMesh target{size * source.vertices, source.faces};
    Anchors anchors;
    for (int vertex = 0; vertex < 12; ++vertex) {
      const Vector3 a = 1.03 * source.vertices.col(vertex);
      anchors.pairs.push_back({"", a, size * a});
    }
    MakeMapOptions options = default_options(diagonal(source.vertices), power_of_two_scale(size));
    options.fit.any_size = true;
    const FittedMapping fit = fit_mapping({source, target, anchors}, options.fit);
    EXPECT_EQ(fit.summary.elastic.anchors_off_surface, anchors.pairs.size()) << size;
    for (const double sigma : fit.anchor_sigma) EXPECT_EQ(sigma, 0) << size;
    for (const double residual : fit.anchor_residual) EXPECT_LT(residual, options.fit.fit_tolerance) << size;
  }
}

TEST(ModelSizes, AreGoneInTheInverse) {
  const TriangleMesh source = ball();
  for (const double size : {0.25, 4.0}) {
    const MadeMap made = made_at(size, source, stretched(source.vertices));
    const DerivedTolerance back = tolerance_of_inverse(made.asset);
    const double there = default_tolerance * diagonal(source.vertices);
    EXPECT_DOUBLE_EQ(back.otherwise, there);
    EXPECT_NEAR(back.diagonal / diagonal(source.vertices), 1, 0.2);
    const Asset inverse = inverted(made).asset;
    EXPECT_EQ(inverse.record.tolerance, there);
    const DerivedTolerance around = tolerance_of_composed(made.asset, inverse);
    EXPECT_DOUBLE_EQ(around.otherwise, there);
    EXPECT_DOUBLE_EQ(around.diagonal, diagonal(source.vertices));
  }
}

}  // namespace
}  // namespace bespoke
