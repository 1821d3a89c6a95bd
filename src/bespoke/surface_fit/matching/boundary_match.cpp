#include "bespoke/surface_fit/matching/boundary_match.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "bespoke/mesh/disjoint_sets.h"
#include "bespoke/parallel.h"

namespace bespoke {

BoundaryMatcher::BoundaryMatcher(const BoundaryMatchInput& input, const BoundarySettings& settings)
    : target_(input.target), rule_(input.rule), settings_(settings) {
  if (target_.boundary_edges().cols() == 0 || rule_ == BoundaryRule::free) return;
  if (input.anchors.cols() == 0 && rule_ == BoundaryRule::automatic) return;
  const Eigen::Matrix2Xi& edges = input.source_rest.boundary_edges();
  const Points& rest = input.source_rest.mesh().vertices;
  // A vertex counts for the length of boundary it stands for, half of both its edges, so that the density of
  // vertices does not matter.
  std::map<int, double> length;
  DisjointSets boundaries(static_cast<int>(rest.cols()));
  for (const auto& edge : edges.colwise()) {
    if (input.source_rest.is_excluded(edge[0]) || input.source_rest.is_excluded(edge[1])) continue;
    const double half = (rest.col(edge[0]) - rest.col(edge[1])).norm() / 2;
    for (int k = 0; k < 2; ++k) length[edge[k]] += half;
    boundaries.join(edge[0], edge[1]);
  }
  std::map<int, int> number_of_least;
  for (const auto& [vertex, own_length] : length) {
    const auto numbered =
        number_of_least.try_emplace(boundaries.least(vertex), static_cast<int>(number_of_least.size()));
    vertices_.push_back(vertex);
    boundary_.push_back(numbered.first->second);
    length_.push_back(own_length);
    if (rule_ == BoundaryRule::automatic)
      anchor_distance_.push_back(
          std::sqrt((input.anchors.colwise() - rest.col(vertex)).colwise().squaredNorm().minCoeff()));
  }
  boundaries_ = static_cast<int>(number_of_least.size());
  accepted_.assign(static_cast<std::size_t>(boundaries_), 0);
}

BoundaryMatch BoundaryMatcher::closest(int vertex, const Points& vertices) const {
  const Points& corners = target_.mesh().vertices;
  const Vector3 x = vertices.col(vertex);
  BoundaryMatch best;
  best.vertex = vertex;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& edge : target_.boundary_edges().colwise()) {
    const Vector3 start = corners.col(edge[0]), along = corners.col(edge[1]) - start;
    const double squared_length = along.squaredNorm();
    if (!(squared_length > 0)) continue;
    const Vector3 point = start + std::clamp((x - start).dot(along) / squared_length, 0.0, 1.0) * along;
    const double squared = (point - x).squaredNorm();
    if (!(squared < least)) continue;
    least = squared;
    best.point = point;
    best.tangent = along / std::sqrt(squared_length);
  }
  return best;
}

void BoundaryMatcher::decide(const Points& vertices) {
  if (rule_ == BoundaryRule::matched) {
    accepted_.assign(accepted_.size(), 1);
    matched_boundaries_ = boundaries_;
    return;
  }
  // Both models were cut at the same place where most of a boundary lies near the target's. How near is
  // judged by the distance of the anchors: the farther they are, the less the coarse warp knows about the
  // place.
  std::vector<int> agree(accepted_.size(), 0), total(accepted_.size(), 0);
  for (std::size_t k = 0; k < vertices_.size(); ++k) {
    const BoundaryMatch found = closest(vertices_[k], vertices);
    const double offset = (found.point - vertices.col(vertices_[k])).norm();
    ++total[boundary_[k]];
    if (offset <= settings_.max_stretch * anchor_distance_[k]) ++agree[boundary_[k]];
  }
  matched_boundaries_ = 0;
  for (std::size_t b = 0; b < accepted_.size(); ++b) {
    accepted_[b] = agree[b] >= settings_.must_agree * total[b] ? 1 : 0;
    matched_boundaries_ += accepted_[b];
  }
}

std::vector<BoundaryMatch> BoundaryMatcher::match(const Points& vertices) const {
  std::vector<std::size_t> active;
  for (std::size_t k = 0; k < vertices_.size(); ++k)
    if (accepted_[boundary_[k]]) active.push_back(k);
  std::vector<BoundaryMatch> matches(active.size());
  constexpr std::size_t grain = 32;
  parallel_for(active.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      matches[i] = closest(vertices_[active[i]], vertices);
      matches[i].length = length_[active[i]];
    }
  });
  return matches;
}

}  // namespace bespoke
