#include "bespoke/surface_fit/graph/geodesic_pose.h"

#include <numbers>

namespace bespoke {
namespace {

constexpr double anywhere = 100;  // diagonals: an anchor of this σ poses nothing

}  // namespace

GeodesicPose::GeodesicPose(const GeodesicPoseInput& input, const PoseSettings& settings)
    : input_(input),
      settings_(settings),
      geodesics_(without_excluded(input.rest, input.patches).mesh, input.target, input.anchor_sources,
                 input.anchor_targets, settings.geodesics),
      posterior_({input.tested, input.given_sigmas, vertex_areas(input.rest).sum()}, settings.outliers),
      sigmas_(input.sigmas) {
  tell_outliers();
  for (const Eigen::Index k : posterior_.outliers()) sigmas_[k] = anywhere;
}

double GeodesicPose::turn_degrees() const {
  const PosingByAnchors posing({input_.rest, input_.anchor_sources, input_.anchor_targets, sigmas_},
                               settings_);
  return posing.rotation_spread() * 180 / std::numbers::pi;
}

AnchorPose GeodesicPose::bent() const {
  const GeodesicPairs between = geodesics_.pairs(inliers());
  const Eigen::Index given = input_.anchor_sources.cols(), added = between.sources.cols();
  Points sources(3, given + added), targets(3, given + added);
  sources << input_.anchor_sources, between.sources;
  targets << input_.anchor_targets, between.targets;
  Eigen::VectorXd sigmas(given + added);
  sigmas << sigmas_, Eigen::VectorXd::Constant(added, settings_.pair_sigma);
  AnchorPose pose = PosingByAnchors({input_.rest, sources, targets, sigmas}, settings_).bent();
  pose.anchor_sources = pose.anchor_sources.leftCols(given).eval();
  return pose;
}

/// k: probabilities of anchors that are not tested are 1.
std::vector<double> GeodesicPose::inliers() const {
  return posterior_.is_active()
             ? posterior_.inliers()
             : std::vector<double>(static_cast<std::size_t>(input_.anchor_sources.cols()), 1);
}

void GeodesicPose::tell_outliers() {
  constexpr int max_rounds = 5;
  for (int round = 0; posterior_.is_active() && round < max_rounds; ++round) {
    const std::vector<Eigen::Index> before = posterior_.outliers();
    posterior_.update(geodesics_.left_out(posterior_.inliers()));
    if (posterior_.outliers() == before) break;
  }
}

}  // namespace bespoke
