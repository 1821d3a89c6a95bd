#include "bespoke/surface_fit/surface_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bespoke/error.h"
#include "support/fitting_scene.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using Scene = test::FittingScene;

TEST(FitSurface, RejectsWhatDoesNotBelongTogether) {
  const TriangleMesh sphere = shapes::icosphere(1);
  Scene scene{sphere, sphere};
  scene.warped = scene.warped.leftCols(5).eval();
  EXPECT_THROW(scene.fit(), InvalidInput);
  scene.warped = sphere.vertices;
  scene.warped(0, 0) = std::nan("");
  EXPECT_THROW(scene.fit(), InvalidInput);
  scene.warped = sphere.vertices;
  scene.anchor_weights = Eigen::VectorXd::Ones(2);
  EXPECT_THROW(scene.fit(), InvalidInput);
  scene.anchor_weights.resize(0);
  SurfaceFitOptions options;
  options.max_iterations = 0;
  EXPECT_THROW(scene.fit(options), InvalidInput);
  options = {};
  options.epsilon = std::nan("");
  EXPECT_THROW(scene.fit(options), InvalidInput);
  scene.target.faces.resize(3, 0);
  EXPECT_THROW(scene.fit(), InvalidInput);
}

TEST(FitSurface, StopsWhenAsked) {
  const TriangleMesh sphere = shapes::icosphere(1);
  const Eigen::VectorXd none(0);
  Progress progress;
  progress.cancelled = [] { return true; };
  EXPECT_THROW(fit_surface({sphere, sphere.vertices, sphere, Points(3, 0), Points(3, 0), none}, {}, progress),
               Interrupted);
}

TEST(SurfaceFitSummary, SaysWhatWasDecidedInOneLine) {
  SurfaceFitSummary summary;
  EXPECT_EQ(to_string(summary).find("anchors off the surface"), std::string::npos);
  summary.off_surface_anchors = 8;
  summary.stop_reason = StopReason::unprinted_cap;
  const std::string line = to_string(summary);
  EXPECT_NE(line.find("8 anchors off the surface"), std::string::npos);
  EXPECT_NE(line.find("which the paper does not have"), std::string::npos);
  EXPECT_EQ(line.find('\n'), std::string::npos);
}

}  // namespace
}  // namespace bespoke
