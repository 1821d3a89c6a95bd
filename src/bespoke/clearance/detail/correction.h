#pragma once

#include <Eigen/SparseCore>
#include <array>
#include <map>
#include <utility>
#include <vector>

#include "bespoke/clearance/detail/missed_samples.h"
#include "bespoke/clearance/detail/prepared_data.h"

namespace bespoke {

/// Of the target's diagonal: what misses nothing moves no farther.
inline constexpr double bystander_share = 0.002;

/// Of the target's diagonal: what a place is pushed in a round at most. Beyond, its gradient is another.
inline constexpr double push_a_round = 0.02;

/// A mean of vertices of the product that is to go along an axis.
struct Push {
  std::vector<std::pair<int, double>> vertices;  ///< with weights, which may be negative
  Vector3 axis;                                  ///< unit
  double missing = 0;                            ///< along it, mesh units; negative where it went farther
  std::array<int, 3> name{};                     ///< the same push in another round has the same
};

/// Of the nodes that move a vertex, with their weights.
using NodeIterator = Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator;

/// The correction of one product on one target, in rounds: constraints are linearised where the product is,
/// and samples that come to miss join them.
class Correction {
 public:
  /// All must outlive it.
  Correction(const PreparedProduct::Data& product, const Points& carried,
             const std::vector<Obstacle>& obstacles);

  /// Until no sample misses, or for `rounds`.
  void solve(SampleDistances& distances, int rounds);

  /// One round more, in which the pushes are constraints as well.
  void push(const std::vector<Push>& pushes, SampleDistances& distances);

  /// `base` and what draws its samples nearer that miss soft obstacles, from where the product is: nothing
  /// that misses no other obstacle comes to do so, nor moves farther than a bystander may.
  void draw(const NodeVectors& base, SampleDistances& distances);
  /// Halves the shares of the nodes at these vertices and around them.
  void shorten_draws(const std::vector<int>& vertices, Eigen::VectorXd& shares) const;

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
  double tolerance() const;  // by which a round may miss its constraints
  bool choose_active(const SampleDistances& distances);
  int nearest_node(const ProductSamples& samples, int sample) const;
  bool count_vain_rounds(const SampleDistances& distances);
  bool let_go_of_parts();
  int vain_rounds(std::size_t obstacle, int node) const;
  bool is_blocked(std::size_t obstacle, int node) const;
  double missing(const SampleDistances& distances, std::size_t obstacle, int sample) const;
  bool misses(const SampleDistances& distances, std::size_t obstacle, int sample) const;
  void note_missing(const SampleDistances& distances, int sample);
  void note_missing_vertex(int vertex);
  std::vector<char> choose_drawn(const SampleDistances& distances);
  void move_to_least_energy(SampleDistances& distances);
  void leave_layers(const std::vector<Push>& pushes, const SampleDistances& distances);
  void append(const std::vector<Push>& pushes, LinearConstraints& constraints);
  void bind_ties();
  LinearConstraints linearised(const SampleDistances& distances) const;
  void set_gradients(const SampleDistances& distances, LinearConstraints& constraints) const;
  void set_differences(const SampleDistances& distances, const std::vector<Eigen::Index>& rows,
                       LinearConstraints& constraints) const;
  std::vector<int> rings(const std::vector<char>& is_start) const;
  void limit(NodeVectors& u) const;

  const PreparedProduct::Data& product_;
  const Points& carried_;
  const std::vector<Obstacle>& obstacles_;
  double size_;                                             // the target's diagonal, by the tolerances
  NodeVectors u_;                                           // of the nodes
  std::vector<Active> active_;                              // with a multiplier each
  std::map<std::pair<std::size_t, int>, int> vain_rounds_;  // of an obstacle and a node
  std::map<std::array<int, 3>, double> multiplier_of_push_;
  std::vector<char> is_missing_node_, is_bound_node_;
  std::vector<double> missing_at_first_;  // of parts: the most that they missed where nothing had moved them
  Eigen::VectorXd multipliers_;
  std::vector<char> moved_;
};

}  // namespace bespoke
