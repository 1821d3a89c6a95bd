#include "bespoke/elastic/finite_elements.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "bespoke/certificate/certificate.h"
#include "bespoke/error.h"
#include "support/error_message.h"
#include "support/instruction_sets.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using testing::HasSubstr;

FiniteElementOptions options_for(double lambda) {
  FiniteElementOptions options;
  options.lambda = lambda;
  options.fit_tolerance = 1e-4 * lambda / 0.1;
  return options;
}

/// A smooth deformation that stretches by half.
Points bent(const Points& x) {
  Points result = x;
  result.row(0) += (0.2 * (2 * x.row(1).array()).sin()).matrix();
  result.row(2) += (0.15 * (3 * x.row(0).array()).cos()).matrix();
  return result;
}

double min_relative_determinant(const BakedMap& map) {
  const Certificate certificate = certify(map.pyramid(), map.affine());
  EXPECT_TRUE(certificate.is_bijection());
  return certificate.min_determinant / certificate.affine_determinant;
}

TEST(FitFiniteElements, AnAffineMapIsItsAffinePart) {
  const TriangleMesh sphere = shapes::icosphere(3);
  Matrix3 linear;
  linear << 1.1, 0.2, 0, 0, 0.9, 0.1, 0.05, 0, 1.3;
  const Points targets = (linear * sphere.vertices).colwise() + Vector3(1, 2, 3);
  const FiniteElementFit fit = fit_finite_elements(sphere.vertices, targets, sphere, options_for(0.3));
  const Points x = 2 * test::random_points(200, 1);
  EXPECT_LT(fit.map->displacement(x).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT(fit.summary.residuals.max, 1e-9);
}

TEST(FitFiniteElements, MeetsVerticesAndIsAffineFarFromThem) {
  const TriangleMesh sphere = shapes::icosphere(4);
  const FiniteElementOptions options = options_for(0.3);
  const FiniteElementFit fit = fit_finite_elements(sphere.vertices, bent(sphere.vertices), sphere, options);
  EXPECT_LT(fit.summary.residuals.p99, 5 * options.fit_tolerance);
  EXPECT_GT(min_relative_determinant(*fit.map), 0.2);
  // Zero beyond λ and one coarse cell.
  const Points far = 1.5 * test::sphere_points(300);
  EXPECT_EQ(fit.map->displacement(far), Points::Zero(3, 300));
}

/// Two parallel plates, a hundredth of their width apart.
TriangleMesh two_plates(double gap) {
  TriangleMesh below = shapes::square_grid(24);
  TriangleMesh above = below;
  above.vertices.row(2).array() += gap;
  return shapes::joined(below, above);
}

TEST(FitFiniteElements, PlatesThatSlideKeepTheVolumeBetweenThem) {
  constexpr double gap = 0.02, slide = 0.06;
  const TriangleMesh plates = two_plates(gap);
  Points targets = plates.vertices;
  targets.rightCols(targets.cols() / 2).row(0).array() += slide;
  FiniteElementOptions options = options_for(0.15);
  const FiniteElementFit fit = fit_finite_elements(plates.vertices, targets, plates, options);
  EXPECT_GT(min_relative_determinant(*fit.map), 0.3);
  EXPECT_LT(fit.summary.residuals.p95, 0.05 * slide);
}

TEST(FitFiniteElements, TheBoundOnSqueezeComesBeforeTheVertices) {
  constexpr double gap = 0.02;
  const TriangleMesh plates = two_plates(gap);
  // The middle of the upper plate comes down to a thousandth of the gap.
  Points targets = plates.vertices;
  for (Eigen::Index i = targets.cols() / 2; i < targets.cols(); ++i) {
    const double r = (targets.col(i) - Vector3(0.5, 0.5, gap)).norm();
    targets(2, i) -= gap * 0.999 * std::exp(-std::pow(r / 0.2, 4));
  }
  const FiniteElementFit fit = fit_finite_elements(plates.vertices, targets, plates, options_for(0.15));
  EXPECT_GE(min_relative_determinant(*fit.map), 1 / options_for(1).max_squeeze * 0.98);
  EXPECT_GT(fit.summary.residuals.max, 0.01 * gap);
}

TEST(FitFiniteElements, DistortionIsAwayFromTheSurface) {
  // A lid turned against a fixed floor: space next to the lid turns with it, that in between shears.
  const TriangleMesh plates = two_plates(0.3);
  const Matrix3 turn = Eigen::AngleAxisd(0.3, Vector3::UnitZ()).toRotationMatrix();
  const auto turned = [&](const Vector3& x) {
    return (turn * (x - Vector3(0.5, 0.5, 0)) + Vector3(0.5, 0.5, 0)).eval();
  };
  Points targets = plates.vertices;
  for (Eigen::Index i = targets.cols() / 2; i < targets.cols(); ++i) targets.col(i) = turned(targets.col(i));
  const FiniteElementFit fit = fit_finite_elements(plates.vertices, targets, plates, options_for(0.3));
  Points beside(3, 2);
  beside << 0.8, 0.8, 0.5, 0.5, 0.27, 0.15;
  const Points images = (*fit.map)(beside);
  const double full = (turned(beside.col(0)) - beside.col(0)).norm();
  const double left_behind = (images.col(0) - turned(beside.col(0))).norm();
  // Of an even shear a tenth of the height costs a tenth of the turn.
  EXPECT_LT(left_behind, 0.08 * full);
}

TEST(FitFiniteElements, NoLevelIsAddedBeyondTheNodesAllowed) {
  const TriangleMesh sphere = shapes::icosphere(4);
  FiniteElementOptions options = options_for(1);
  options.fit_tolerance /= 10;
  const auto nodes = [&] {
    const FiniteElementSummary summary =
        fit_finite_elements(sphere.vertices, bent(sphere.vertices), sphere, options).summary;
    return std::accumulate(summary.nodes.begin(), summary.nodes.end(), std::size_t{0});
  };
  const std::size_t unbounded = nodes();
  options.max_nodes = unbounded / 2;
  // Corners of split cells come on top.
  EXPECT_LT(nodes(), 0.75 * static_cast<double>(unbounded));
}

TEST(FitFiniteElements, ATargetTwiceAsLargeHasTheSameMapTwiceAsLarge) {
  const TriangleMesh sphere = shapes::icosphere(3);
  const Points targets = bent(sphere.vertices);
  FiniteElementOptions options = options_for(0.3);
  const FiniteElementFit one = fit_finite_elements(sphere.vertices, targets, sphere, options);
  options.fit_tolerance *= 2;
  const FiniteElementFit two = fit_finite_elements(sphere.vertices, 2 * targets, sphere, options);
  const Points x = 1.2 * test::random_points(100, 3);
  EXPECT_LT(((*two.map)(x)-2 * (*one.map)(x)).cwiseAbs().maxCoeff(), options.fit_tolerance);
}

TEST(FitFiniteElements, HasTheSameBitsWithEveryInstructionSet) {
  const TriangleMesh sphere = shapes::icosphere(2);
  const Points targets = bent(sphere.vertices);
  test::expect_same_bits_with_every_instruction_set([&] {
    const FiniteElementFit fit = fit_finite_elements(sphere.vertices, targets, sphere, options_for(0.4));
    std::vector<double> values;
    for (const PyramidLevel& level : fit.map->pyramid().levels)
      values.insert(values.end(), level.values.begin(), level.values.end());
    return values;
  });
}

TEST(FitFiniteElements, RefusesWhatItCannotFit) {
  const TriangleMesh sphere = shapes::icosphere(1);
  const auto refusal = [&](const Points& targets, const FiniteElementOptions& options) {
    return test::error_message<InvalidInput>(
        [&] { fit_finite_elements(sphere.vertices, targets, sphere, options); });
  };
  EXPECT_THAT(refusal(Points::Zero(3, 2), options_for(0.3)), HasSubstr("2 targets"));
  EXPECT_THAT(refusal(sphere.vertices * std::nan(""), options_for(0.3)), HasSubstr("not finite"));
  EXPECT_THAT(refusal(sphere.vertices, options_for(0)), HasSubstr("effective distance"));
  EXPECT_THAT(refusal(-sphere.vertices, options_for(0.3)), HasSubstr("mirror image"));
  FiniteElementOptions squeezed = options_for(0.3);
  squeezed.max_squeeze = 1;
  EXPECT_THAT(refusal(sphere.vertices, squeezed), HasSubstr("squeeze"));
}

}  // namespace
}  // namespace bespoke
