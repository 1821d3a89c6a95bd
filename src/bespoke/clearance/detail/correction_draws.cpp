#include <algorithm>
#include <utility>

#include "bespoke/clearance/detail/correction.h"

namespace bespoke {
namespace {

// What is drawn and what holds it lie next to each other.
constexpr int iterations_of_draws = 60;

// Less of a draw is none.
constexpr double min_share = 0.1;

}  // namespace

void Correction::draw(const NodeVectors& base, SampleDistances& distances) {
  const std::vector<char> is_drawn = choose_drawn(distances);
  if (active_.empty()) return;
  LinearConstraints constraints = linearised(distances);
  constraints.amounts -=
      NodeVectors(constraints.places * base).cwiseProduct(constraints.gradients).rowwise().sum();
  NodeVectors further =
      minimised_energy(product_.energy, constraints, tolerance(), iterations_of_draws, multipliers_);
  const std::vector<int> ring = rings(is_drawn);
  const double most = bystander_share * size_;
  NodeVectors u = base;
  for (Eigen::Index node = 0; node < u.rows(); ++node) {
    const auto at = static_cast<std::size_t>(node);
    if (ring[at] >= reach_in_edges) continue;
    if (const double length = further.row(node).norm(); length > most) further.row(node) *= most / length;
    u.row(node) += further.row(node);
    if (const double length = u.row(node).norm(); !is_bound_node_[at] && length > most)
      u.row(node) *= most / length;
  }
  move_to(std::move(u), distances);
}

void Correction::shorten_draws(const std::vector<int>& vertices, Eigen::VectorXd& shares) const {
  std::vector<char> is_near(static_cast<std::size_t>(shares.size()), 0);
  for (const int vertex : vertices)
    for (NodeIterator it(product_.graph.vertex_from_node, vertex); it; ++it) {
      is_near[static_cast<std::size_t>(it.col())] = 1;
      for (Eigen::SparseMatrix<double>::InnerIterator next(product_.graph.weights, it.col()); next; ++next)
        is_near[static_cast<std::size_t>(next.row())] = 1;
    }
  for (Eigen::Index node = 0; node < shares.size(); ++node)
    if (is_near[static_cast<std::size_t>(node)])
      shares[node] = shares[node] > min_share ? shares[node] / 2 : 0;
}

/// Of every node the sample that misses soft obstacles most, and the one that is nearest to missing another.
/// n flags: nodes that are drawn.
std::vector<char> Correction::choose_drawn(const SampleDistances& distances) {
  std::vector<char> is_drawn(is_missing_node_.size(), 0);
  active_.clear();
  for (std::size_t o = 0; o < obstacles_.size(); ++o) {
    const bool is_soft = obstacles_[o].is_soft;
    std::vector<int> worst(is_missing_node_.size(), -1);
    for (int i = 0; i < static_cast<int>(distances.samples().count()); ++i) {
      const auto node = static_cast<std::size_t>(nearest_node(distances.samples(), i));
      if (is_soft && !distances.misses(o, i)) continue;
      const double now = missing(distances, o, i);
      if (!(now > -2 * bystander_share * size_) || is_blocked(o, static_cast<int>(node))) continue;
      if (worst[node] < 0 || now > missing(distances, o, worst[node])) worst[node] = i;
      if (is_soft) is_drawn[node] = 1;
    }
    for (const int i : worst)
      if (i >= 0) active_.push_back({o, i, missing(distances, o, i)});
  }
  multipliers_.setZero(static_cast<Eigen::Index>(active_.size()));
  return is_drawn;
}

}  // namespace bespoke
