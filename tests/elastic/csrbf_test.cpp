#include "bespoke/elastic/csrbf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "bespoke/error.h"
#include "support/arithmetic.h"
#include "support/error_message.h"
#include "support/finite_differences.h"
#include "support/random_points.h"

namespace bespoke {
namespace {

using testing::HasSubstr;

CsrbfOptions with_lambda(double lambda) {
  CsrbfOptions options;
  options.lambda = lambda;
  return options;
}

template <class ExpectedError>
std::string refusal(const Points& sources, const Points& targets, const CsrbfOptions& options) {
  return test::error_message<ExpectedError>([&] { fit_csrbf(sources, targets, options); });
}

Points wavy(const Points& x) { return x + 0.1 * (3 * x.array()).sin().matrix().colwise().reverse(); }

TEST(FitCsrbf, Interpolates) {
  for (const double lambda : {0.05, 0.2, 0.5, 2.5}) {
    const Points sources = test::sphere_points(1500);
    const CsrbfFit fit = fit_csrbf(sources, wavy(sources), with_lambda(lambda));
    EXPECT_LT(test::largest_distance((*fit.map)(sources), wavy(sources)), 1e-9) << "lambda " << lambda;
    EXPECT_EQ(fit.summary.residual, test::largest_distance((*fit.map)(sources), wavy(sources)));
  }
}

TEST(FitCsrbf, ReproducesAffineMapsEverywhere) {
  AffineMap map;
  map.linear << 2, 1, 0, -1, 1, 3, 0.5, 0, 1;
  map.offset << 4, 5, -6;
  const Points sources = test::sphere_points(800).colwise() + Vector3(3, -2, 7);
  const CsrbfFit fit = fit_csrbf(sources, map * sources, with_lambda(0.4));
  const Points x = (1.5 * test::random_points(2000, 1)).colwise() + Vector3(3, -2, 7);
  EXPECT_LT(test::largest_distance((*fit.map)(x), map * x), 1e-10);
  EXPECT_LT((fit.map->affine().linear - map.linear).norm(), 1e-11);
}

TEST(FitCsrbf, IsExactlyAffineBeyondLambda) {
  const Points sources = test::sphere_points(500);
  const CsrbfFit fit = fit_csrbf(sources, wavy(sources), with_lambda(0.3));
  const Points x = 2 * test::random_points(1000, 2);
  const Points u = fit.map->displacement(x);
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    if ((sources.colwise() - x.col(i)).colwise().norm().minCoeff() >= 0.3) {
      EXPECT_EQ(u.col(i), Vector3::Zero());
    }
}

TEST(FitCsrbf, SupportHoldsEveryPointThatMoves) {
  const Points sources = test::sphere_points(300);
  const CsrbfFit fit = fit_csrbf(sources, wavy(sources), with_lambda(0.3));
  const Support support = fit.map->support();
  ASSERT_EQ(support.clouds.size(), 1u);
  EXPECT_EQ(support.clouds[0].radius, 0.3);
  EXPECT_EQ(support.clouds[0].centers, sources);
}

TEST(FitCsrbf, GradientEqualsFiniteDifferences) {
  const Points sources = test::sphere_points(500);
  const CsrbfFit fit = fit_csrbf(sources, wavy(sources), with_lambda(0.5));
  const Points x = 1.2 * test::random_points(200, 3);
  const Points slope = test::finite_differences(*fit.map, x, 1e-5);
  EXPECT_LT((fit.map->displacement_gradient(x) - slope).colwise().norm().maxCoeff(), 1e-6);
}

TEST(FitCsrbf, DisconnectedPiecesDoNotFeelEachOther) {
  Points sources(3, 400);
  sources << test::sphere_points(200), test::sphere_points(200).colwise() + Vector3(5, 0, 0);
  Points targets = sources;
  targets.leftCols(200) = wavy(sources.leftCols(200));
  const CsrbfFit fit = fit_csrbf(sources, targets, with_lambda(0.3));
  EXPECT_LT(test::largest_distance((*fit.map)(sources), targets), 1e-10);
}

TEST(FitCsrbf, RefusesUnusableSources) {
  const Points points = test::sphere_points(50);
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal<InvalidInput>(points, points, with_lambda(0)), HasSubstr("must be positive"));
  EXPECT_THAT(refusal<InvalidInput>(points, points, with_lambda(nan)), HasSubstr("must be positive"));
  EXPECT_THAT(refusal<InvalidInput>(points, points.leftCols(4), with_lambda(1)), HasSubstr("must be equal"));
  EXPECT_THAT(refusal<InvalidInput>(points.leftCols(3), points.leftCols(3), with_lambda(1)),
              HasSubstr("there are 3"));
  EXPECT_THAT(refusal<InvalidInput>(Points(3, 0), Points(3, 0), with_lambda(1)), HasSubstr("there are 0"));
  EXPECT_THAT(refusal<InvalidInput>(Points::Ones(3, 6), Points::Ones(3, 6), with_lambda(1)),
              HasSubstr("one place"));
  Points twice = points;
  twice.col(41) = twice.col(7);
  EXPECT_THAT(refusal<InvalidInput>(twice, points, with_lambda(1)), HasSubstr("7 and 41"));
  Points flat = test::random_points(30, 4);
  flat.row(1).setConstant(3);
  EXPECT_THAT(refusal<InvalidInput>(flat, flat, with_lambda(1)), HasSubstr("coplanar"));
  Points broken = points;
  broken(2, 3) = nan;
  EXPECT_THAT(refusal<InvalidInput>(broken, points, with_lambda(1)), HasSubstr("not finite"));
  EXPECT_THAT(refusal<InvalidInput>(points, broken, with_lambda(1)), HasSubstr("not finite"));
}

TEST(EstimateCsrbf, CountsAndGrows) {
  const Points sources = test::sphere_points(2000);
  CsrbfEstimate before;
  for (const double lambda : {0.1, 0.2, 0.4}) {
    const CsrbfEstimate estimate = estimate_csrbf(sources, with_lambda(lambda));
    EXPECT_TRUE(estimate.within_limits);
    EXPECT_EQ(estimate.advised_lambda, lambda);
    // A cap of height λ²/2 covers λ²/4 of the unit sphere.
    EXPECT_NEAR(estimate.entries_per_row, 2000 * lambda * lambda / 4, 0.1 * 2000 * lambda * lambda / 4 + 1);
    EXPECT_GT(estimate.factor_entries, before.factor_entries);
    EXPECT_GT(estimate.bytes, 8 * estimate.factor_entries);
    EXPECT_GT(estimate.condition, before.condition);
    before = estimate;
  }
}

void expect_good_advice(const Points& sources, CsrbfOptions options) {
  const CsrbfEstimate estimate = estimate_csrbf(sources, options);
  ASSERT_FALSE(estimate.within_limits);
  ASSERT_GT(estimate.advised_lambda, 0);
  ASSERT_LT(estimate.advised_lambda, options.lambda);
  // The advice is no more careful than the limits require.
  CsrbfOptions larger = options;
  larger.lambda = 1.1 * estimate.advised_lambda;
  EXPECT_FALSE(estimate_csrbf(sources, larger).within_limits);
  options.lambda = estimate.advised_lambda;
  const CsrbfFit fit = fit_csrbf(sources, wavy(sources), options);
  EXPECT_LT(fit.summary.residual, 1e-6);
}

TEST(FitCsrbf, AdvisesALambdaThatWorksWhenMemoryIsShort) {
  const Points sources = test::sphere_points(4000);
  CsrbfOptions options = with_lambda(0.7);
  options.max_memory = std::size_t{24} << 20;
  EXPECT_THAT(refusal<MemoryLimitError>(sources, sources, options),
              HasSubstr("effective distance of at most"));
  expect_good_advice(sources, options);
}

TEST(FitCsrbf, AdvisesALambdaThatWorksWhenTheConditionIsBad) {
  const Points sources = test::sphere_points(3000);
  CsrbfOptions options = with_lambda(1);
  options.max_condition = 1e9;
  EXPECT_THAT(refusal<SolverError>(sources, sources, options), HasSubstr("effective distance of at most"));
  expect_good_advice(sources, options);
}

TEST(FitCsrbf, SaysWhenNoLambdaFits) {
  CsrbfOptions options = with_lambda(0.5);
  options.max_memory = 1000;
  EXPECT_THAT(refusal<MemoryLimitError>(test::sphere_points(500), test::sphere_points(500), options),
              HasSubstr("no effective distance fits"));
}

TEST(CsrbfSummary, PrintsOneLine) {
  const Points sources = test::sphere_points(100);
  const std::string line = to_string(fit_csrbf(sources, sources, with_lambda(0.5)).summary);
  EXPECT_THAT(line, HasSubstr("100 centres"));
  EXPECT_EQ(line.find('\n'), std::string::npos);
}

/// Vertices of an OBJ file; empty where the file is absent.
Points obj_vertices(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::vector<double> coordinates;
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("v ", 0) != 0) continue;
    std::istringstream numbers(line.substr(2));
    for (double value; numbers >> value;) coordinates.push_back(value);
  }
  return Eigen::Map<const Points>(coordinates.data(), 3, Eigen::Index(coordinates.size() / 3));
}

TEST(FitCsrbf, RefusesARealBodyAtTenPercentWithAdviceThatWorks) {
  const Points sources =
      obj_vertices(std::filesystem::path(BESPOKE_SHARED_DIR) / "cases/d01_body_dress/reference_a.obj");
  if (sources.cols() == 0) GTEST_SKIP() << "no shared cases here";
  const double diagonal = (sources.rowwise().maxCoeff() - sources.rowwise().minCoeff()).norm();
  EXPECT_THAT(refusal<SolverError>(sources, sources, with_lambda(0.1 * diagonal)),
              HasSubstr("effective distance of at most"));
  expect_good_advice(sources, with_lambda(0.1 * diagonal));
}

}  // namespace
}  // namespace bespoke
