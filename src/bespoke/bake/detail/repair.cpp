#include "bespoke/bake/detail/repair.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "bespoke/certificate/fold_list.h"
#include "bespoke/lattice/leaf_table.h"
#include "bespoke/lattice/pyramid_index.h"

namespace bespoke {
namespace {

constexpr int sweeps_per_round = 2;
// Of the way to the neighbours' mean (damped Jacobi): a full step leaves the alternating mode undamped.
constexpr double step_fraction = 0.7;
// Rounds on one level's nodes before those of the next coarser one are moved, which carry the finer residuals
// along. A sweep smooths over one cell, so a fold that is many cells wide needs coarser ones. These change
// the map in a wider neighbourhood, so they come last and only for the folds that are left.
constexpr int rounds_per_level = 10;
constexpr int levels_upwards = 3;
// A node and its six neighbours.
constexpr Eigen::Index stencil = 7;
// A level is given up when so many rounds leave more than this share of its folds.
constexpr std::size_t patience = 4;
constexpr double min_left = 0.9;

using Node = LatticeCoordinates;

// Nodes of one level that may move, by their place in the level's values.
using MovableNodes = std::map<std::pair<int, Node>, std::size_t>;

// Untangling: nodes at folds move to the mean of their neighbours, by damped Jacobi sweeps of Laplace's
// equation.
class Repair {
 public:
  explicit Repair(Pyramid& pyramid) : pyramid_(pyramid), index_(pyramid) {
    for (const PyramidLevel& level : pyramid.levels) tables_.emplace_back(level.leaves);
  }

  void forget_nodes() { nodes_.clear(); }

  // Of the cell that holds the folded one, `coarser` levels up.
  void add_corners(const FoldedCell& cell, int coarser) {
    const int level = std::max(0, cell.level - coarser);
    const Node lower = pyramid_.lattice(level).cell_of(cell.center);
    for (int corner = 0; corner < 8; ++corner) add_node(level, moved(lower, corner_step(corner)));
  }

  void grow() {
    const MovableNodes inner = nodes_;
    for (const auto& [place, offset] : inner)
      for (int side = 0; side < neighbour_steps; ++side)
        add_node(place.first, moved(place.second, neighbour_step(side)));
  }

  // Every movable node moves towards the mean of its six neighbours; one level after the other, because nodes
  // of several levels may lie at one place and their moves would add up.
  void sweep() {
    for (int level = 0; level < static_cast<int>(pyramid_.levels.size()); ++level) sweep_level(level);
  }

  // By level.
  std::vector<std::vector<Node>> movable() const {
    std::vector<std::vector<Node>> nodes(pyramid_.levels.size());
    for (const auto& [place, offset] : nodes_)
      nodes[static_cast<std::size_t>(place.first)].push_back(place.second);
    return nodes;
  }

  double largest_change() const {
    double largest = 0;
    for (const auto& [place, change] : moved_) largest = std::max(largest, change.norm());
    return largest;
  }

 private:
  void sweep_level(int level) {
    constexpr int lowest = std::numeric_limits<int>::min();
    const auto begin = nodes_.lower_bound({level, {lowest, lowest, lowest}});
    const auto end = nodes_.lower_bound({level + 1, {lowest, lowest, lowest}});
    if (begin == end) return;
    const Lattice lattice = pyramid_.lattice(level);
    Points x(3, stencil * std::distance(begin, end));
    Eigen::Index column = 0;
    for (auto at = begin; at != end; ++at, column += stencil)
      put_stencil(lattice, at->first.second, x, column);
    const Points u = look_up(pyramid_, index_, x);
    column = 0;
    for (auto at = begin; at != end; ++at, column += stencil) {
      const Vector3 mean = u.middleCols(column + 1, stencil - 1).rowwise().mean();
      const Vector3 change = step_fraction * (mean - u.col(column));
      move(&pyramid_.levels[static_cast<std::size_t>(level)].values[at->second], change);
      moved_.try_emplace(at->first, Vector3::Zero()).first->second += change;
    }
  }

  static void put_stencil(const Lattice& lattice, const Node& node, Points& x, Eigen::Index column) {
    x.col(column++) = lattice(node);
    for (int axis = 0; axis < 3; ++axis)
      for (const double step : {-1.0, 1.0})
        x.col(column++) = lattice.at(as_vector(node) + step * Vector3::Unit(axis));
  }

  void move(float* value, const Vector3& change) const {
    for (int c = 0; c < 3; ++c) {
      value[c] += static_cast<float>(change[c]);
      if (pyramid_.precision == ValuePrecision::half) value[c] = rounded_to_half(value[c]);
    }
  }

  void add_node(int level, const Node& node) {
    const int leaf = tables_[static_cast<std::size_t>(level)].find(leaf_of(node));
    if (leaf == no_leaf) return;
    nodes_[{level, node}] = static_cast<std::size_t>(leaf) * leaf_floats +
                            static_cast<std::size_t>(3 * number_of_place(place_in_leaf(node)));
  }

  Pyramid& pyramid_;
  PyramidIndex index_;  // leaves stay where they are, so it sees every change of their values
  std::vector<LeafTable> tables_;
  MovableNodes nodes_;
  std::map<std::pair<int, Node>, Vector3> moved_;
};

}  // namespace

RepairSummary repair_folds(Pyramid& pyramid, const AffineMap& affine, const std::vector<FoldedCell>& folds,
                           const Progress& progress) {
  RepairSummary summary;
  summary.cells = summary.folded = folds.size();
  if (summary.cells == 0 || !(affine.linear.determinant() > 0)) return summary;
  Repair repair(pyramid);
  FoldList list(pyramid, affine, folds);
  for (int coarser = 0; coarser < levels_upwards && summary.folded > 0; ++coarser) {
    std::vector<std::size_t> left = {summary.folded};
    for (int round = 0; round < rounds_per_level && summary.folded > 0; ++round) {
      progress.check();
      repair.forget_nodes();
      for (const FoldedCell& cell : list.places()) repair.add_corners(cell, coarser);
      if (round > rounds_per_level / 2) repair.grow();
      for (int sweep = 0; sweep < sweeps_per_round; ++sweep) repair.sweep();
      list.update(repair.movable());
      summary.folded = list.places().size();
      left.push_back(summary.folded);
      if (left.size() > patience && static_cast<double>(summary.folded) >
                                        min_left * static_cast<double>(left[left.size() - 1 - patience]))
        break;
    }
  }
  summary.largest_change = repair.largest_change();
  return summary;
}

}  // namespace bespoke
