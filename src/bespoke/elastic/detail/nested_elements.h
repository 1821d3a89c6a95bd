#pragma once

#include <array>
#include <vector>

#include "bespoke/lattice/lattice.h"
#include "bespoke/lattice/leaf_table.h"
#include "bespoke/lattice/pyramid.h"
#include "bespoke/types.h"

namespace bespoke {

/// A place in a finest cell: the corners' numbers among the level's points, and their trilinear weights.
struct ElementPlace {
  int level = 0;
  std::array<int, 8> corners{};
  std::array<double, 8> weights{};
};

/// One level of nested trilinear elements.
struct ElementLevel {
  double voxel_size = 0;                    ///< mesh units
  std::vector<LatticeCoordinates> nodes;    ///< that hold an unknown, in lexicographic order
  std::vector<LatticeCoordinates> points;   ///< corners of the level's cells
  std::vector<int> point_of_node;           ///< one per node
  std::vector<LatticeCoordinates> cells;    ///< lower corners
  std::vector<std::array<int, 8>> corners;  ///< points, one array per cell, by corner_step
  std::vector<int> first_part;      ///< per cell: the first of its eight parts on the finer level, or no_leaf
  std::vector<int> finest;          ///< cells that no finer level splits
  std::vector<double> weights;      ///< of the distortion in the finest cells, > 0, 1 unless weighed
  std::vector<int> incident_begin;  ///< one more than there are points
  std::vector<std::size_t> incident;  ///< corners of finest cells at a point: 8·(number in finest) + corner
  std::vector<int> parents_begin;     ///< one more than there are points
  std::vector<int> parents;           ///< points of the coarser level whose mean interpolates a point
  LeafTable cell_table;               ///< finds cells by their lower corner
  std::size_t first_unknown = 0;      ///< of the first node, among those of all levels
};

/// The functions that a Pyramid can hold (lattice/pyramid.h) as finite elements: a hat function per node, on
/// nested levels. A cell that a finer node's function reaches is split into eight, and all corners of a split
/// cell are nodes. The union of the finest cells of all levels tiles the support.
class NestedElements {
 public:
  /// nodes: wanted, coarse to fine; corners of split cells are added.
  NestedElements(const Lattice& coarsest, std::vector<std::vector<LatticeCoordinates>> nodes);

  const std::vector<ElementLevel>& levels() const { return levels_; }
  Lattice lattice(std::size_t level) const { return {origin_, levels_[level].voxel_size}; }
  std::size_t unknowns() const { return unknowns_; }  ///< nodes of all levels

  /// Weights of the finest cells, per level, as ElementLevel::finest lists them; > 0, no unit.
  void weigh(std::vector<std::vector<double>> weights);

  /// Places of x, one per level from 0 to the finest whose cells hold it; empty outside of all cells.
  std::vector<ElementPlace> places(const Vector3& x) const;

  /// coefficients: 3×unknowns(). Values at the points of a level: its own and those of the coarser ones.
  std::vector<Points> values(const Points& coefficients) const;
  void evaluate(const Points& coefficients, std::vector<Points>& values) const;  ///< the same, in place

  /// The transpose: from gradients with respect to the values at every level's points (changed) to those of
  /// the coefficients, 3×unknowns().
  Points restricted(std::vector<Points>& gradients) const;

 private:
  void split(std::vector<std::vector<LatticeCoordinates>>& nodes);
  void add_points(ElementLevel& level, const ElementLevel* coarser);

  Vector3 origin_;
  std::vector<ElementLevel> levels_;
  std::size_t unknowns_ = 0;
};

/// Coefficients of `from` for the nodes of `to` (zero at new ones), 3×unknowns.
Points transferred(const NestedElements& from, const Points& coefficients, const NestedElements& to);

/// linear · coefficients as a pyramid.
Pyramid pyramid_of(const NestedElements& elements, const Points& coefficients, const Matrix3& linear);

}  // namespace bespoke
