#include "bespoke/clearance/detail/correction.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "bespoke/mesh/disjoint_sets.h"

namespace bespoke {
namespace {

// By ring of edges around what misses: whole for two, since a face sample misses between its corners, then
// down to nothing where the reach ends, smoothly.
constexpr std::array<double, reach_in_edges> share_of_ring = {1, 1, 0.85, 0.5, 0.15};

constexpr int iterations_a_round = 30;

// A gradient shorter than this is that of a place as near to one side as to another.
constexpr double min_gradient = 0.2;

// Beyond the band of what is stored distances are all the same. Central differences over a step doubled so
// often reach it from four voxels deeper.
constexpr int max_doublings = 3;

// A round that brings a sample less than this share of the way that it was pushed was in vain. After so many
// there is no space for its distance, and it is only kept outside; after as many again for none at all.
constexpr double min_gain = 0.3;
constexpr int max_vain_rounds = 2;

// Of what a part missed: one side pushes it so far, three perpendicular ones √3 times.
constexpr double max_shift = 2;

// Of the tolerance: how exactly a round meets its linear constraints, and what is aimed for beyond what is
// required: together within the tolerance, so that the next round finds them met.
constexpr double solved_share = 1, aimed_share = 0.5;

}  // namespace

Correction::Correction(const PreparedProduct::Data& product, const Points& carried,
                       const std::vector<Obstacle>& obstacles)
    : product_(product),
      carried_(carried),
      obstacles_(obstacles),
      size_(0),
      u_(NodeVectors::Zero(product.graph.nodes(), 3)),
      is_missing_node_(static_cast<std::size_t>(product.graph.nodes()), 0),
      is_bound_node_(is_missing_node_),
      missing_at_first_(is_missing_node_.size(), 0),
      moved_(static_cast<std::size_t>(carried.cols()), 0) {
  for (const Obstacle& obstacle : obstacles)
    size_ = std::max(size_, obstacle.tolerance / clearance_tolerance);
}

double Correction::tolerance() const {
  double least = std::numeric_limits<double>::infinity();
  for (const Obstacle& obstacle : obstacles_) least = std::min(least, obstacle.tolerance);
  return solved_share * least;
}

void Correction::solve(SampleDistances& distances, int rounds) {
  bool let_go = false;
  for (int round = 0; round < rounds && (choose_active(distances) || let_go); ++round) {
    move_to_least_energy(distances);
    let_go = count_vain_rounds(distances);
    let_go = let_go_of_parts() || let_go;
  }
}

void Correction::move_to_least_energy(SampleDistances& distances) {
  NodeVectors u = NodeVectors::Zero(u_.rows(), 3);
  if (!active_.empty())
    u = minimised_energy(product_.energy, linearised(distances), tolerance(), iterations_a_round,
                         multipliers_);
  limit(u);
  move_to(std::move(u), distances);
}

void Correction::move_to(NodeVectors u, SampleDistances& distances) {
  u_ = std::move(u);
  const NodeVectors moves = product_.graph.vertex_from_node * u_;
  for (std::size_t v = 0; v < moved_.size(); ++v)
    moved_[v] = !moves.row(static_cast<Eigen::Index>(v)).isZero(0);
  distances.look(vertices());
}

Points Correction::vertices() const {
  Points corrected = carried_;
  const NodeVectors moves = product_.graph.vertex_from_node * u_;
  for (Eigen::Index v = 0; v < corrected.cols(); ++v)
    if (moved_[static_cast<std::size_t>(v)]) corrected.col(v) += moves.row(v).transpose();
  return corrected;
}

NodeVectors Correction::joined(const std::vector<std::pair<int, int>>& pairs) const {
  DisjointSets sets(static_cast<int>(u_.rows()));
  std::vector<int> nodes;
  const auto join = [&](int face, int& first) {
    for (const int vertex : product_.mesh.faces.col(face))
      for (NodeIterator it(product_.graph.vertex_from_node, vertex); it; ++it) {
        const int node = static_cast<int>(it.col());
        nodes.push_back(node);
        if (first < 0) first = node;
        sets.join(first, node);
      }
  };
  for (const auto& [a, b] : pairs) {
    int first = -1;
    join(a, first);
    join(b, first);
  }
  std::map<int, int> farthest;
  for (const int node : nodes) {
    int& at = farthest.try_emplace(sets.least(node), node).first->second;
    if (u_.row(node).squaredNorm() > u_.row(at).squaredNorm()) at = node;
  }
  NodeVectors u = u_;
  for (const int node : nodes) u.row(node) = u_.row(farthest.at(sets.least(node)));
  return u;
}

std::vector<char> Correction::involved() const {
  std::vector<char> flags(moved_.size(), 0);
  const auto& rows = product_.graph.vertex_from_node;
  for (Eigen::Index v = 0; v < rows.rows(); ++v) {
    // What goes with others has several nodes, or one that is not at its place.
    int nodes = 0;
    for (NodeIterator it(rows, v); it; ++it, ++nodes)
      if (is_bound_node_[static_cast<std::size_t>(it.col())]) flags[static_cast<std::size_t>(v)] = 1;
    if (nodes > 1) flags[static_cast<std::size_t>(v)] = 1;
  }
  return flags;
}

void Correction::note_missing(const SampleDistances& distances, int sample) {
  for (int k = 0; k < 3; ++k)
    if (distances.samples().weights(k, sample) > 0)
      note_missing_vertex(distances.samples().vertices(k, sample));
}

void Correction::note_missing_vertex(int vertex) {
  for (NodeIterator it(product_.graph.vertex_from_node, vertex); it; ++it)
    is_missing_node_[static_cast<std::size_t>(it.col())] = 1;
}

void Correction::bind_ties() {
  is_bound_node_ = is_missing_node_;
  for (Eigen::Index node = 0; node < product_.graph.weights.cols(); ++node) {
    const auto at = static_cast<std::size_t>(node);
    if (!is_missing_node_[at] || !product_.graph.is_tied[at]) continue;
    for (Eigen::SparseMatrix<double>::InnerIterator it(product_.graph.weights, node); it; ++it)
      if (product_.graph.is_tied[static_cast<std::size_t>(it.row())])
        is_bound_node_[static_cast<std::size_t>(it.row())] = 1;
  }
}

/// Where a push at the sample goes first.
int Correction::nearest_node(const ProductSamples& samples, int sample) const {
  Eigen::Index corner = 0;
  samples.weights.col(sample).maxCoeff(&corner);
  int nearest = 0;
  double most = 0;
  for (NodeIterator it(product_.graph.vertex_from_node, samples.vertices(corner, sample)); it; ++it)
    if (it.value() > most) {
      most = it.value();
      nearest = static_cast<int>(it.col());
    }
  return nearest;
}

/// Asks less of nodes whose samples rounds did not bring nearer, then nothing: there is no space, and pushing
/// on would fold the product.
bool Correction::count_vain_rounds(const SampleDistances& distances) {
  std::set<std::pair<std::size_t, int>> vain;
  for (const Active& active : active_) {
    const double expected = std::min(active.missing, push_a_round * size_);
    const double gained = active.missing - missing(distances, active.obstacle, active.sample);
    if (!misses(distances, active.obstacle, active.sample) || gained > min_gain * expected) continue;
    vain.emplace(active.obstacle, nearest_node(distances.samples(), active.sample));
  }
  bool let_go = false;
  for (const auto& one : vain) let_go = ++vain_rounds_[one] % max_vain_rounds == 0 || let_go;
  return let_go;
}

/// Lets go of parts that have moved much farther than they missed: what presses them from two sides pushes a
/// stiff counter off its heel, where it misses nothing and fits nobody.
bool Correction::let_go_of_parts() {
  bool let_go = false;
  for (std::size_t node = 0; node < missing_at_first_.size(); ++node) {
    const auto row = static_cast<Eigen::Index>(node);
    if (!product_.graph.is_part[node] || !(u_.row(row).norm() > max_shift * missing_at_first_[node]))
      continue;
    for (std::size_t o = 0; o < obstacles_.size(); ++o)
      vain_rounds_[{o, static_cast<int>(node)}] = 2 * max_vain_rounds;
    let_go = true;
  }
  return let_go;
}

int Correction::vain_rounds(std::size_t obstacle, int node) const {
  const auto found = vain_rounds_.find({obstacle, node});
  return found == vain_rounds_.end() ? 0 : found->second;
}

bool Correction::is_blocked(std::size_t obstacle, int node) const {
  return vain_rounds(obstacle, node) >= 2 * max_vain_rounds;
}

/// By what is still required of its node.
double Correction::missing(const SampleDistances& distances, std::size_t obstacle, int sample) const {
  return vain_rounds_.empty() ||
                 vain_rounds(obstacle, nearest_node(distances.samples(), sample)) < max_vain_rounds
             ? distances.missing(obstacle, sample)
             : distances.missing_outside(obstacle, sample);
}

bool Correction::misses(const SampleDistances& distances, std::size_t obstacle, int sample) const {
  return distances.misses(obstacle, sample) &&
         missing(distances, obstacle, sample) > obstacles_[obstacle].tolerance;
}

/// Keeps what pushes, and adds of what misses the worst sample around each node: its neighbours follow it.
/// Whether any is there.
bool Correction::choose_active(const SampleDistances& distances) {
  std::vector<Active> active;
  std::vector<double> multipliers;
  std::set<std::pair<std::size_t, int>> is_active;
  for (std::size_t i = 0; i < active_.size(); ++i) {
    const Active& was = active_[i];
    const double multiplier = multipliers_[static_cast<Eigen::Index>(i)];
    if (!(multiplier > 0) || is_blocked(was.obstacle, nearest_node(distances.samples(), was.sample)))
      continue;
    active.push_back(was);
    multipliers.push_back(multiplier);
    is_active.emplace(was.obstacle, was.sample);
  }
  bool any = false;
  for (std::size_t o = 0; o < obstacles_.size(); ++o) {
    if (obstacles_[o].is_soft) continue;
    std::vector<int> worst(is_missing_node_.size(), -1);
    for (int i = 0; i < static_cast<int>(distances.samples().count()); ++i) {
      if (!misses(distances, o, i)) continue;
      const int node = nearest_node(distances.samples(), i);
      if (is_blocked(o, node)) continue;
      any = true;
      note_missing(distances, i);
      if (u_.row(node).isZero(0)) {
        double& most = missing_at_first_[static_cast<std::size_t>(node)];
        most = std::max(most, missing(distances, o, i));
      }
      int& at = worst[static_cast<std::size_t>(node)];
      if (at < 0 || missing(distances, o, i) > missing(distances, o, at)) at = i;
    }
    for (const int i : worst)
      if (i >= 0 && !is_active.contains({o, i})) {
        active.push_back({o, i, 0});
        multipliers.push_back(0);
      }
  }
  for (Active& next : active) next.missing = missing(distances, next.obstacle, next.sample);
  active_ = std::move(active);
  multipliers_ =
      Eigen::Map<Eigen::VectorXd>(multipliers.data(), static_cast<Eigen::Index>(multipliers.size()));
  if (any) bind_ties();
  return any;
}

/// Of distances at the samples: what is known, else central differences.
void Correction::set_gradients(const SampleDistances& distances, LinearConstraints& constraints) const {
  for (std::size_t o = 0; o < obstacles_.size(); ++o) {
    std::vector<Eigen::Index> rows;
    for (std::size_t i = 0; i < active_.size(); ++i) {
      if (active_[i].obstacle != o) continue;
      const auto row = static_cast<Eigen::Index>(i);
      constraints.gradients.row(row) = distances.gradient(o, active_[i].sample);
      if (!obstacles_[o].planes) rows.push_back(row);
    }
    if (!rows.empty()) set_differences(distances, rows, constraints);
  }
}

void Correction::set_differences(const SampleDistances& distances, const std::vector<Eigen::Index>& rows,
                                 LinearConstraints& constraints) const {
  const Obstacle& obstacle = obstacles_[active_[static_cast<std::size_t>(rows.front())].obstacle];
  const Points places = places_of(distances.samples(), vertices());
  std::vector<Eigen::Index> left = rows;
  double step = obstacle.step;
  for (int doubling = 0; doubling <= max_doublings && !left.empty(); ++doubling, step *= 2) {
    Points around(3, 6 * static_cast<Eigen::Index>(left.size()));
    for (std::size_t i = 0; i < left.size(); ++i)
      for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side)
          around.col(6 * static_cast<Eigen::Index>(i) + 2 * axis + side) =
              places.col(active_[static_cast<std::size_t>(left[i])].sample) +
              (side ? -step : step) * Vector3::Unit(axis);
    const std::vector<double> values = obstacle.distance(around);
    std::vector<Eigen::Index> beyond;
    for (std::size_t i = 0; i < left.size(); ++i) {
      Vector3 gradient;
      for (std::size_t axis = 0; axis < 3; ++axis)
        gradient[static_cast<Eigen::Index>(axis)] =
            (values[6 * i + 2 * axis] - values[6 * i + 2 * axis + 1]) / (2 * step);
      if (gradient.isZero(0)) beyond.push_back(left[i]);
      // What is beyond the band looks at its rim, where differences are partly none.
      if (doubling == 0 && !(gradient.norm() > min_gradient)) gradient.setZero();
      constraints.gradients.row(left[i]) = gradient.normalized();
    }
    left = std::move(beyond);
  }
}

LinearConstraints Correction::linearised(const SampleDistances& distances) const {
  const auto count = static_cast<Eigen::Index>(active_.size());
  LinearConstraints constraints{
      {count, product_.graph.nodes()}, NodeVectors(count, 3), Eigen::VectorXd(count)};
  std::vector<Eigen::Triplet<double>> entries;
  const ProductSamples& samples = distances.samples();
  for (Eigen::Index i = 0; i < count; ++i) {
    const int sample = active_[static_cast<std::size_t>(i)].sample;
    for (int k = 0; k < 3; ++k)
      if (samples.weights(k, sample) > 0)
        for (NodeIterator it(product_.graph.vertex_from_node, samples.vertices(k, sample)); it; ++it)
          entries.emplace_back(i, it.col(), samples.weights(k, sample) * it.value());
  }
  constraints.places.setFromTriplets(entries.begin(), entries.end());
  set_gradients(distances, constraints);
  const NodeVectors now = constraints.places * u_;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Active& active = active_[static_cast<std::size_t>(i)];
    const double pushed = std::min(missing(distances, active.obstacle, active.sample), push_a_round * size_);
    constraints.amounts[i] = constraints.gradients.row(i).isZero(0)
                                 ? -size_
                                 : pushed + aimed_share * obstacles_[active.obstacle].tolerance +
                                       constraints.gradients.row(i).dot(now.row(i));
  }
  return constraints;
}

/// Of every node: edges to the next one that misses, reach_in_edges from there on.
std::vector<int> Correction::rings(const std::vector<char>& is_start) const {
  std::vector<int> ring(is_missing_node_.size(), reach_in_edges);
  std::vector<int> front;
  for (std::size_t node = 0; node < ring.size(); ++node)
    if (is_start[node]) {
      ring[node] = 0;
      front.push_back(static_cast<int>(node));
    }
  for (int next = 1; next < reach_in_edges; ++next) {
    std::vector<int> following;
    for (const int node : front)
      for (Eigen::SparseMatrix<double>::InnerIterator it(product_.graph.weights, node); it; ++it)
        if (int& at = ring[static_cast<std::size_t>(it.row())]; at > next) {
          at = next;
          following.push_back(static_cast<int>(it.row()));
        }
    front = std::move(following);
  }
  return ring;
}

void Correction::limit(NodeVectors& u) const {
  const std::vector<int> ring = rings(is_missing_node_);
  const double most = bystander_share * size_;
  for (Eigen::Index node = 0; node < u.rows(); ++node) {
    const auto at = static_cast<std::size_t>(node);
    if (ring[at] >= reach_in_edges) {
      u.row(node).setZero();
      continue;
    }
    u.row(node) *= share_of_ring[static_cast<std::size_t>(ring[at])];
    if (const double length = u.row(node).norm(); !is_bound_node_[at] && length > most)
      u.row(node) *= most / length;
  }
}

}  // namespace bespoke
