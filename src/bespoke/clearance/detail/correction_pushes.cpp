#include <algorithm>
#include <utility>

#include "bespoke/clearance/detail/correction.h"

namespace bespoke {
namespace {

// Pushes of neighbouring faces counteract each other.
constexpr int iterations_of_pushes = 60;

}  // namespace

void Correction::push(const std::vector<Push>& pushes, SampleDistances& distances) {
  choose_active(distances);
  leave_layers(pushes, distances);
  LinearConstraints constraints = linearised(distances);
  append(pushes, constraints);
  bind_ties();
  const Eigen::Index before = multipliers_.size();
  multipliers_.conservativeResize(constraints.amounts.size());
  for (std::size_t i = 0; i < pushes.size(); ++i)
    multipliers_[before + static_cast<Eigen::Index>(i)] = multiplier_of_push_[pushes[i].name];
  NodeVectors u =
      minimised_energy(product_.energy, constraints, tolerance(), iterations_of_pushes, multipliers_);
  for (std::size_t i = 0; i < pushes.size(); ++i)
    multiplier_of_push_[pushes[i].name] = multipliers_[before + static_cast<Eigen::Index>(i)];
  multipliers_.conservativeResize(before);
  limit(u);
  move_to(std::move(u), distances);
}

/// Drops distances from layers where pushes are: to lie on the right side counts more.
void Correction::leave_layers(const std::vector<Push>& pushes, const SampleDistances& distances) {
  std::vector<char> is_pushed(is_missing_node_.size(), 0);
  for (const Push& push : pushes)
    for (const auto& [vertex, weight] : push.vertices)
      for (NodeIterator it(product_.graph.vertex_from_node, vertex); it; ++it)
        is_pushed[static_cast<std::size_t>(it.col())] = 1;
  std::vector<Active> active;
  std::vector<double> multipliers;
  for (std::size_t i = 0; i < active_.size(); ++i) {
    const int node = nearest_node(distances.samples(), active_[i].sample);
    if (obstacles_[active_[i].obstacle].planes && is_pushed[static_cast<std::size_t>(node)]) continue;
    active.push_back(active_[i]);
    multipliers.push_back(multipliers_[static_cast<Eigen::Index>(i)]);
  }
  active_ = std::move(active);
  multipliers_ =
      Eigen::Map<Eigen::VectorXd>(multipliers.data(), static_cast<Eigen::Index>(multipliers.size()));
}

/// Adds the pushes' rows.
void Correction::append(const std::vector<Push>& pushes, LinearConstraints& constraints) {
  const Eigen::Index before = constraints.amounts.size();
  const Eigen::Index count = before + static_cast<Eigen::Index>(pushes.size());
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index row = 0; row < before; ++row)
    for (NodeIterator it(constraints.places, row); it; ++it) entries.emplace_back(row, it.col(), it.value());
  for (std::size_t i = 0; i < pushes.size(); ++i)
    for (const auto& [vertex, weight] : pushes[i].vertices) {
      if (pushes[i].missing > 0) note_missing_vertex(vertex);
      for (NodeIterator it(product_.graph.vertex_from_node, vertex); it; ++it)
        entries.emplace_back(before + static_cast<Eigen::Index>(i), it.col(), weight * it.value());
    }
  constraints.places.resize(count, product_.graph.nodes());
  constraints.places.setFromTriplets(entries.begin(), entries.end());
  constraints.gradients.conservativeResize(count, 3);
  constraints.amounts.conservativeResize(count);
  const NodeVectors now = constraints.places * u_;
  for (std::size_t i = 0; i < pushes.size(); ++i) {
    const Eigen::Index row = before + static_cast<Eigen::Index>(i);
    constraints.gradients.row(row) = pushes[i].axis;
    constraints.amounts[row] =
        std::min(pushes[i].missing, push_a_round * size_) + constraints.gradients.row(row).dot(now.row(row));
  }
}

}  // namespace bespoke
