#include "bespoke/elastic/multiscale.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>

#include "bespoke/error.h"
#include "bespoke/rigid/rigid_alignment.h"
#include "support/arithmetic.h"
#include "support/error_message.h"
#include "support/finite_differences.h"
#include "support/random_points.h"

namespace bespoke {
namespace {

using testing::HasSubstr;
using testing::Not;

MultiscaleOptions with_options(double lambda, double tolerance, bool composed) {
  MultiscaleOptions options;
  options.lambda = lambda;
  options.tolerance = tolerance;
  options.composed = composed;
  return options;
}

/// A smooth, strong deformation.
Points wrung(const Points& x) {
  Points result = x;
  result.row(0) += (0.3 * (2 * x.row(1).array()).sin()).matrix();
  result.row(1) += (0.2 * (3 * x.row(2).array()).cos()).matrix();
  result.row(2) *= 1.4;
  return result;
}

/// Within `reach` of the sources.
Points band_points(const Points& sources, int count, double reach, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_int_distribution<Eigen::Index> pick(0, sources.cols() - 1);
  Points x = reach / std::sqrt(3.0) * test::random_points(count, seed + 1);
  for (auto point : x.colwise()) point += sources.col(pick(generator));
  return x;
}

std::string refusal(const Points& sources, const Points& targets, const MultiscaleOptions& options) {
  return test::error_message<InvalidInput>([&] { fit_multiscale(sources, targets, options); });
}

class FitMultiscale : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(, FitMultiscale, testing::Values(false, true),
                         [](const auto& composed) { return composed.param ? "Composed" : "Summed"; });

TEST_P(FitMultiscale, MeetsTheTolerance) {
  const Points sources = test::sphere_points(4000);
  const Points targets = wrung(sources);
  for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
    const MultiscaleFit fit = fit_multiscale(sources, targets, with_options(0.6, tolerance, GetParam()));
    EXPECT_EQ(fit.summary.within_tolerance, 4000u);
    EXPECT_LE(test::largest_distance((*fit.map)(sources), targets), tolerance);
    EXPECT_NEAR(fit.summary.residuals.max, test::largest_distance((*fit.map)(sources), targets), 1e-12);
  }
}

TEST_P(FitMultiscale, ReproducesAffineMapsWithoutAnyLayer) {
  AffineMap map;
  map.linear << 2, 1, 0, -1, 1, 3, 0.5, 0, 1;
  map.offset << 4, 5, -6;
  const Points sources = test::sphere_points(500).colwise() + Vector3(3, -2, 7);
  const MultiscaleFit fit = fit_multiscale(sources, map * sources, with_options(0.5, 1e-6, GetParam()));
  EXPECT_TRUE(fit.map->layers().empty());
  const Points x = 10 * test::random_points(100, 1);
  EXPECT_LT(test::largest_distance((*fit.map)(x), map * x), 1e-10);
}

TEST_P(FitMultiscale, IsExactlyAffineOutsideTheSupportItReports) {
  const Points sources = test::sphere_points(1000);
  const MultiscaleFit fit = fit_multiscale(sources, wrung(sources), with_options(0.4, 1e-3, GetParam()));
  const Support support = fit.map->support();
  const Points x = 2 * test::random_points(3000, 2);
  const Points u = fit.map->displacement(x);
  const Points gradient = fit.map->displacement_gradient(x);
  int outside = 0;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const Vector3 y = support.frame * Vector3(x.col(i));
    bool inside = false;
    for (const BallCloud& cloud : support.clouds)
      inside = inside || (cloud.centers.colwise() - y).colwise().norm().minCoeff() < cloud.radius;
    if (inside) continue;
    ++outside;
    EXPECT_EQ(u.col(i), Vector3::Zero());
    EXPECT_EQ(gradient.middleCols<3>(3 * i), Points::Zero(3, 3));
  }
  EXPECT_GT(outside, 1000);
}

TEST_P(FitMultiscale, GradientEqualsFiniteDifferences) {
  const Points sources = test::sphere_points(1000);
  const MultiscaleFit fit = fit_multiscale(sources, wrung(sources), with_options(0.6, 1e-3, GetParam()));
  const Points x = band_points(sources, 300, 0.5, 3);
  const Points slope = test::finite_differences(*fit.map, x, 1e-6);
  EXPECT_LT((fit.map->displacement_gradient(x) - slope).colwise().norm().maxCoeff(), 1e-5);
}

TEST_P(FitMultiscale, GivesTheSameBitsTwice) {
  const Points sources = test::sphere_points(1500);
  const auto options = with_options(0.5, 1e-3, GetParam());
  const Points x = band_points(sources, 500, 0.5, 4);
  EXPECT_EQ(fit_multiscale(sources, wrung(sources), options).map->displacement(x),
            fit_multiscale(sources, wrung(sources), options).map->displacement(x));
}

TEST_P(FitMultiscale, DisconnectedPiecesMoveApart) {
  Points sources(3, 1000);
  sources << test::sphere_points(500), test::sphere_points(500).colwise() + Vector3(4, 0, 0);
  Points targets = sources;
  targets.leftCols(500).row(1).array() += 0.2;
  const MultiscaleFit fit = fit_multiscale(sources, targets, with_options(0.6, 1e-3, GetParam()));
  EXPECT_LE(test::largest_distance((*fit.map)(sources), targets), 1e-3);
}

TEST_P(FitMultiscale, TakesASingleTriangleAndASinglePoint) {
  const Points triangle = Matrix3::Identity();
  const Points moved = 2 * triangle;
  const MultiscaleFit fit = fit_multiscale(triangle, moved, with_options(0.5, 1e-3, GetParam()));
  EXPECT_LT(test::largest_distance((*fit.map)(triangle), moved), 1e-3);
  const MultiscaleFit point =
      fit_multiscale(triangle.col(0), moved.col(0), with_options(0.5, 1e-3, GetParam()));
  EXPECT_LT(test::largest_distance((*point.map)(triangle.col(0)), moved.col(0)), 1e-12);
}

TEST_P(FitMultiscale, CountsWhatCannotBeMet) {
  Points sources = test::sphere_points(500);
  sources.col(17) = sources.col(5);
  Points targets = sources;
  targets.col(17) += Vector3(0.1, 0, 0);
  const MultiscaleFit fit = fit_multiscale(sources, targets, with_options(0.5, 1e-3, GetParam()));
  EXPECT_LT(fit.summary.within_tolerance, 500u);
  EXPECT_GE(fit.summary.within_tolerance, 490u);
  EXPECT_GE(fit.summary.residuals.max, 0.05 * 0.9);
}

TEST_P(FitMultiscale, RefusesUnusableInput) {
  const bool composed = GetParam();
  const Points points = test::sphere_points(100);
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal(points, points.leftCols(5), with_options(1, 1e-3, composed)),
              HasSubstr("must be equal"));
  EXPECT_THAT(refusal(Points(3, 0), Points(3, 0), with_options(1, 1e-3, composed)), HasSubstr("no sources"));
  EXPECT_THAT(refusal(points, points, with_options(nan, 1e-3, composed)), HasSubstr("effective distance"));
  EXPECT_THAT(refusal(points, points, with_options(1, 0, composed)), HasSubstr("tolerance"));
  EXPECT_THAT(refusal(points, points, with_options(1, nan, composed)), HasSubstr("tolerance"));
  Points broken = points;
  broken(1, 1) = nan;
  EXPECT_THAT(refusal(broken, points, with_options(1, 1e-3, composed)), HasSubstr("not finite"));
  EXPECT_THAT(refusal(points, broken, with_options(1, 1e-3, composed)), HasSubstr("not finite"));
  EXPECT_THAT(refusal(points, -points, with_options(1, 1e-3, composed)), HasSubstr("mirror"));
}

TEST(FitMultiscaleComposed, DoesNotFoldWhereTheDataFolds) {
  // One half of the sphere is pushed through the other: no map without folds meets these targets.
  const Points sources = test::sphere_points(400);
  Points targets = sources;
  for (auto target : targets.colwise())
    if (target.z() > 0.5) target.z() -= 1.6;
  const MultiscaleFit fit = fit_multiscale(sources, targets, with_options(0.8, 1e-3, true));
  const Points x = band_points(sources, 30000, 0.8, 5);
  const Points gradient = fit.map->displacement_gradient(x);
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    ASSERT_GT((fit.map->affine().linear + gradient.middleCols<3>(3 * i)).determinant(), 0);
  EXPECT_LT(fit.summary.within_tolerance, 400u);
}

TEST(FitMultiscaleComposed, ReportsGradientBoundsThatHold) {
  const Points sources = test::sphere_points(1500);
  const MultiscaleFit fit = fit_multiscale(sources, wrung(sources), with_options(0.6, 1e-3, true));
  ASSERT_EQ(fit.summary.gradient_bounds.size(), fit.map->layers().size());
  for (std::size_t k = 0; k < fit.map->layers().size(); ++k) {
    EXPECT_LT(fit.summary.gradient_bounds[k], 1);
    const RbfLayer& layer = fit.map->layers()[k];
    const MultiscaleMap alone(AffineMap{}, {layer}, false);
    const Points gradient = alone.displacement_gradient(band_points(layer.centers, 5000, layer.lambda, 6));
    for (Eigen::Index i = 0; i < gradient.cols(); i += 3)
      EXPECT_LE(Matrix3(gradient.middleCols<3>(i)).operatorNorm(), fit.summary.gradient_bounds[k]);
  }
}

/// Three numbers a line, after `prefix`; empty where the file is absent.
Points read_points(const std::filesystem::path& path, const std::string& prefix) {
  std::ifstream file(path);
  std::vector<double> coordinates;
  for (std::string line; std::getline(file, line);) {
    if (line.rfind(prefix, 0) != 0) continue;
    std::istringstream numbers(line.substr(prefix.size()));
    for (double value; numbers >> value;) coordinates.push_back(value);
  }
  return Eigen::Map<const Points>(coordinates.data(), 3, Eigen::Index(coordinates.size() / 3));
}

TEST(FitMultiscaleComposed, MeetsRealBodiesHandsAndFeetWithoutFolds) {
  for (const char* name : {"d01_body_dress", "d04_hand_glove", "d05_foot_shoe"}) {
    const auto folder = std::filesystem::path(BESPOKE_SHARED_DIR) / "cases" / name;
    const Points sources = read_points(folder / "reference_a.obj", "v ");
    if (sources.cols() == 0) GTEST_SKIP() << "no shared cases here";
    Points targets = read_points(folder / "gt_a_on_b.xyz", "");
    targets = inverse(align_rigidly(sources, targets, Eigen::VectorXd::Ones(sources.cols()))) * targets;
    const double diagonal = (sources.rowwise().maxCoeff() - sources.rowwise().minCoeff()).norm();
    const MultiscaleFit fit =
        fit_multiscale(sources, targets, with_options(0.1 * diagonal, 1e-4 * diagonal, true));
    EXPECT_GE(double(fit.summary.within_tolerance), 0.99 * double(sources.cols())) << name;
    const Points gradient = fit.map->displacement_gradient(band_points(sources, 100000, 0.1 * diagonal, 7));
    for (Eigen::Index i = 0; i < gradient.cols(); i += 3)
      ASSERT_GT((fit.map->affine().linear + gradient.middleCols<3>(i)).determinant(), 0) << name;
  }
}

TEST(MultiscaleMap, ComposesAfterTheAffinePart) {
  AffineMap affine;
  affine.linear *= 2;
  const RbfLayer layer{1.0, Vector3(2, 0, 0), Vector3(0, 0.1, 0)};
  const MultiscaleMap composed(affine, {layer}, true);
  EXPECT_EQ(composed(Points(Vector3(1, 0, 0))), Points(Vector3(2, 0.1, 0)));
  const MultiscaleMap summed(affine, {layer}, false);
  EXPECT_EQ(summed(Points(Vector3(2, 0, 0))), Points(Vector3(4, 0.1, 0)));
}

TEST(MultiscaleHalves, AreTheMapOneAfterTheOther) {
  const Points sources = test::sphere_points(400);
  const MultiscaleFit fit = fit_multiscale(sources, wrung(sources), with_options(0.6, 1e-3, true));
  const auto [first, second] = halves(*fit.map, fit.summary);
  ASSERT_GT(fit.map->layers().size(), 2u);
  const std::size_t half = first.map->layers().size();
  EXPECT_LE(2 * half, fit.map->layers().size());
  EXPECT_GE(2 * half + 1, fit.map->layers().size());
  const Points x = 3 * test::random_points(2000, 4);
  EXPECT_LT(test::largest_distance((*second.map)((*first.map)(x)), (*fit.map)(x)), 1e-12);

  const auto joined = [&](auto member) {
    auto all = first.summary.*member;
    all.insert(all.end(), (second.summary.*member).begin(), (second.summary.*member).end());
    return all;
  };
  EXPECT_EQ(joined(&MultiscaleSummary::lambdas), fit.summary.lambdas);
  EXPECT_EQ(joined(&MultiscaleSummary::centers), fit.summary.centers);
  EXPECT_EQ(joined(&MultiscaleSummary::gradient_bounds), fit.summary.gradient_bounds);
  EXPECT_EQ(second.summary.within_tolerance, fit.summary.within_tolerance);
  EXPECT_EQ(first.summary.residuals.count, 0u) << "what is missed is known at the end alone";
  EXPECT_THAT(to_string(first.summary), Not(HasSubstr("residual")));
}

TEST(MultiscaleHalves, AreRefusedWhereThereAreNone) {
  const Points sources = test::sphere_points(400);
  const MultiscaleFit summed = fit_multiscale(sources, wrung(sources), with_options(0.6, 1e-3, false));
  EXPECT_THAT(test::error_message<InvalidInput>([&] { halves(*summed.map, summed.summary); }),
              HasSubstr("summed"));
  const MultiscaleMap single(AffineMap{}, {summed.map->layers().front()}, true);
  EXPECT_THAT(test::error_message<InvalidInput>([&] { halves(single, {}); }), HasSubstr("1 composed"));
}

TEST(MultiscaleSummary, PrintsOneLine) {
  const Points sources = test::sphere_points(300);
  const std::string line =
      to_string(fit_multiscale(sources, wrung(sources), with_options(0.5, 1e-2, true)).summary);
  EXPECT_THAT(line, HasSubstr("300 of 300"));
  EXPECT_EQ(line.find('\n'), std::string::npos);
}

}  // namespace
}  // namespace bespoke
