#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "bespoke/elastic/csrbf.h"
#include "bespoke/mesh/mesh_io.h"
#include "bespoke/pipeline/fit_mapping.h"

namespace bespoke {
namespace {

namespace fs = std::filesystem;

/// Real pairs whose true correspondence is known.
class SharedCase : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    folder_ = fs::path(BESPOKE_SHARED_DIR) / "cases" / GetParam();
    if (!fs::exists(folder_)) GTEST_SKIP() << folder_ << " is absent";
    source_ = read_triangle_mesh(folder_ / "reference_a.obj");
    target_ = read_triangle_mesh(folder_ / "reference_b.obj");
    anchors_ = read_anchors(folder_ / "anchors.json");
    std::ifstream truth(folder_ / "gt_a_on_b.xyz");
    truth_.resize(3, source_.vertices.cols());
    for (Eigen::Index i = 0; i < truth_.size(); ++i) truth >> truth_(i);
    ASSERT_TRUE(truth);
  }

  /// Mean distance from the true places, % of the source's bounding-box diagonal.
  double mean_error(const FittedMapping& fit) const {
    const Points image = fit.target_from_source * (*fit.elastic)(source_.vertices);
    return 100 * (image - truth_).colwise().norm().mean() / diagonal(source_.vertices);
  }

  fs::path folder_;
  TriangleMesh source_;
  TriangleMesh target_;
  Anchors anchors_;
  Points truth_;
};

TEST_P(SharedCase, SurfaceFittingFindsTheTruePlacesBetterThanTheAnchorsAlone) {
  FitOptions options;
  options.lambda = 0.1 * diagonal(source_.vertices);
  options.elastic = ElasticMethod::pffd_smooth;
  const double error = mean_error(fit_mapping(source_, target_, anchors_, options));
  // One step of a surface that cannot bend, then the snap: all that the anchors know.
  options.surface_fit.method = SurfaceFitMethod::laplacian;
  options.surface_fit.max_iterations = 1;
  options.surface_fit.stiffness = 1e9;
  EXPECT_LT(error, mean_error(fit_mapping(source_, target_, anchors_, options)));
}

TEST_P(SharedCase, AdvisedLambdaWorks) {
  FitOptions options;
  options.elastic = ElasticMethod::csrbf;
  CsrbfOptions asked;
  asked.lambda = 0.1 * diagonal(source_.vertices);
  options.lambda = estimate_csrbf(source_.vertices, asked).advised_lambda;
  ASSERT_GT(options.lambda, 0);
  EXPECT_LE(options.lambda, asked.lambda);
  const FittedMapping fit = fit_mapping(source_, target_, anchors_, options);
  EXPECT_LT(fit.summary.elastic.vertex_residuals.max, 1e-6 * diagonal(source_.vertices));
}

INSTANTIATE_TEST_SUITE_P(Cases, SharedCase, ::testing::Values("d04_hand_glove", "d06_head_hat"));

}  // namespace
}  // namespace bespoke
