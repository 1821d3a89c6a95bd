#pragma once

#include <Eigen/SparseCore>
#include <map>
#include <utility>
#include <vector>

#include "bespoke/clearance/detail/missed_samples.h"
#include "bespoke/clearance/detail/prepared_data.h"

namespace bespoke {

/// The correction of one product on one target, in rounds: constraints are linearised where the product is,
/// and samples that come to miss join them.
class Correction {
 public:
  /// All must outlive it.
  Correction(const PreparedProduct::Data& product, const Points& carried,
             const std::vector<Obstacle>& obstacles);

  /// Until no sample misses, or for `rounds`.
  void solve(SampleDistances& distances, int rounds);

  /// The displacement of the nodes, and another one.
  const NodeVectors& displacement() const { return u_; }
  void move_to(NodeVectors u, SampleDistances& distances);

  /// The displacement in which the nodes of each pair of faces, and of pairs that share nodes, move as the
  /// one of them that moves farthest: what did not pass through each other as carried, does not then.
  NodeVectors joined(const std::vector<std::pair<int, int>>& pairs) const;

  /// 3×n: the carried vertices where nothing moves them, to the bit.
  Points vertices() const;
  /// n flags.
  const std::vector<char>& moved() const { return moved_; }
  /// n flags: vertices of samples that missed, and what is tied to them.
  std::vector<char> involved() const;

 private:
  struct Active {
    std::size_t obstacle;
    int sample;
    double missing;  ///< before the round, mesh units
  };
  bool choose_active(const SampleDistances& distances);
  int nearest_node(const ProductSamples& samples, int sample) const;
  bool count_vain_rounds(const SampleDistances& distances);
  bool is_hopeless(std::size_t obstacle, int node) const;
  void note_missing(const SampleDistances& distances, int sample);
  void bind_ties();
  LinearConstraints linearised(const SampleDistances& distances) const;
  void set_gradients(const SampleDistances& distances, LinearConstraints& constraints) const;
  std::vector<int> rings() const;
  void limit(NodeVectors& u) const;

  const PreparedProduct::Data& product_;
  const Points& carried_;
  const std::vector<Obstacle>& obstacles_;
  double size_;                                             // the target's diagonal, by the tolerances
  NodeVectors u_;                                           // of the nodes
  std::vector<Active> active_;                              // with a multiplier each
  std::map<std::pair<std::size_t, int>, int> vain_rounds_;  // of an obstacle and a node
  std::vector<char> is_missing_node_, is_bound_node_;
  Eigen::VectorXd multipliers_;
  std::vector<char> moved_;
};

}  // namespace bespoke
