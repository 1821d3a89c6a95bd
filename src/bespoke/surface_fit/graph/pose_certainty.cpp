#include "bespoke/surface_fit/graph/pose_certainty.h"

#include <algorithm>
#include <cmath>

#include "bespoke/parallel.h"

namespace bespoke {

Eigen::VectorXd pose_certainty(const Points& vertices, const Points& anchors, double reach) {
  constexpr Eigen::Index neighbour_count = 3;
  Eigen::VectorXd certainty = Eigen::VectorXd::Zero(vertices.cols());
  if (anchors.cols() < neighbour_count) return certainty;
  constexpr std::size_t grain = 256;
  parallel_for(static_cast<std::size_t>(vertices.cols()), grain, [&](std::size_t begin, std::size_t end) {
    for (auto i = static_cast<Eigen::Index>(begin); i < static_cast<Eigen::Index>(end); ++i) {
      Eigen::VectorXd squared = (anchors.colwise() - vertices.col(i)).colwise().squaredNorm();
      std::nth_element(squared.begin(), squared.begin() + neighbour_count - 1, squared.end());
      certainty[i] = std::exp(-squared[neighbour_count - 1] / (reach * reach));
    }
  });
  return certainty;
}

}  // namespace bespoke
