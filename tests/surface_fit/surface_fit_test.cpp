#include "bespoke/surface_fit/surface_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "bespoke/error.h"
#include "bespoke/surface_fit/surface_fit_methods.h"
#include "support/error_message.h"
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

TEST(FitSurface, TestsAnchorsOfATargetThatIsInsideOutToo) {
  TriangleMesh inside_out = shapes::icosphere(3);
  inside_out.vertices.row(1) *= 1.2;
  Scene scene{shapes::icosphere(3), inside_out};
  scene.target.faces.row(1).swap(scene.target.faces.row(2));
  scene.anchor_sources = scene.source.vertices.leftCols(12);
  scene.anchor_targets = inside_out.vertices.leftCols(12);
  scene.anchor_weights = Eigen::VectorXd::Constant(12, std::numeric_limits<double>::infinity());
  scene.anchor_tested.assign(12, 1);
  const SurfaceFit fit = scene.fit();
  EXPECT_TRUE(fit.summary.target_flipped);
  EXPECT_TRUE(fit.summary.tested_anchors);
}

// Files of meshes are written inside out now and then; what nearest points say of either side settles it.
TEST(FitSurface, TurnsATargetOverThatIsInsideOut) {
  TriangleMesh target = shapes::icosphere(3);
  target.vertices.row(1) *= 1.2;
  TriangleMesh inside_out = target;
  inside_out.faces.row(1).swap(inside_out.faces.row(2));
  for (const SurfaceFitEntry& entry : surface_fits) {
    SurfaceFitOptions options;
    options.method = entry.value;
    const SurfaceFit expected = Scene{shapes::icosphere(3), target}.fit(options);
    const SurfaceFit fit = Scene{shapes::icosphere(3), inside_out}.fit(options);
    EXPECT_FALSE(expected.summary.target_flipped) << entry.name;
    EXPECT_TRUE(fit.summary.target_flipped) << entry.name;
    EXPECT_EQ(fit.vertices, expected.vertices) << entry.name;
    EXPECT_NE(to_string(fit.summary).find("faces flipped"), std::string::npos);
    options.repair_models = false;
    EXPECT_FALSE((Scene{shapes::icosphere(3), inside_out}.fit(options).summary.target_flipped));
  }
}

// Anchors that name the same places of either lay one inside out onto the other.
TEST(FitSurface, RefusesAMirrorImageButNotASheetThatLooksTheOtherWay) {
  Scene scene{shapes::icosphere(3), shapes::icosphere(3)};
  scene.warped.row(0) *= -1;
  for (const bool repair_models : {true, false}) {
    SurfaceFitOptions options;
    options.repair_models = repair_models;
    EXPECT_THAT(test::error_message<InvalidInput>([&] { scene.fit(options); }),
                ::testing::HasSubstr("mirror it back first"));
  }

  const TriangleMesh sheet = shapes::square_grid(9);
  TriangleMesh other_way = sheet;
  other_way.faces.row(1).swap(other_way.faces.row(2));
  EXPECT_TRUE((Scene{sheet, other_way}.fit().summary.target_flipped));
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
