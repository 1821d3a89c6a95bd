#include "bespoke/surface_fit/graph/anchor_posterior.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "bespoke/median.h"

namespace bespoke {

AnchorPosterior::AnchorPosterior(TestedAnchors anchors, const OutlierAnchorSettings& settings)
    : anchors_(std::move(anchors)), settings_(settings), inliers_(anchors_.tested.size(), 1) {
  if (anchors_.sigmas.size() == 0)
    anchors_.sigmas = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(inliers_.size()));
  active_ = std::count(anchors_.tested.begin(), anchors_.tested.end(), 1) >= settings.min_tested;
}

void AnchorPosterior::update(const LeftOutAnchors& left_out) {
  const double median_of_normal = 2 * std::log(2.0);  // of squared lengths in a plane, in variances
  const Eigen::ArrayXd squared = left_out.distances.array().square();
  std::vector<double> all;
  for (std::size_t k = 0; k < inliers_.size(); ++k)
    if (anchors_.tested[k]) {
      const auto at = static_cast<Eigen::Index>(k);
      all.push_back(squared[at] / left_out.compliances[at]);
    }
  const double count = static_cast<double>(all.size());
  const double scale = median(std::move(all)) / median_of_normal;
  const double floor = std::pow(settings_.min_deviation, 2);
  std::size_t outliers = 0;
  for (std::size_t k = 0; k < inliers_.size(); ++k) {
    if (!anchors_.tested[k]) continue;
    const auto at = static_cast<Eigen::Index>(k);
    const double variance =
        std::max(scale * left_out.compliances[at], floor) + anchors_.sigmas[at] * anchors_.sigmas[at];
    const double inlier = (1 - settings_.expected) * std::exp(-squared[at] / (2 * variance)) /
                          (2 * std::numbers::pi * variance);
    inliers_[k] = inlier / (inlier + settings_.expected / anchors_.area);
    outliers += inliers_[k] < 0.5 ? 1 : 0;
  }
  if (static_cast<double>(outliers) > count / 3) std::fill(inliers_.begin(), inliers_.end(), 1.0);
}

std::vector<Eigen::Index> AnchorPosterior::outliers() const {
  std::vector<Eigen::Index> found;
  for (std::size_t k = 0; k < inliers_.size(); ++k)
    if (inliers_[k] < 0.5) found.push_back(static_cast<Eigen::Index>(k));
  return found;
}

}  // namespace bespoke
