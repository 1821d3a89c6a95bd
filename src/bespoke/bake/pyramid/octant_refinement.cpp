#include "bespoke/bake/pyramid/octant_refinement.h"

#include <algorithm>
#include <array>

#include "bespoke/bake/band.h"
#include "bespoke/bake/pyramid/octant_test.h"
#include "bespoke/mapping/affine_map.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

// Halving the voxels divides a residual by four once they resolve the map; with fewer of them in the radius
// of a ball they may not.
constexpr double resolving_voxels_per_radius = 4;
constexpr std::size_t octants_per_call = (1 << 16) / tested_nodes;

// Whether the cell has a corner in a missing leaf. There the level drops to zero, and the error is what the
// level-boundary rule (rim_neighbours) tolerates at that level boundary: a finer leaf would not reduce it,
// and would have a level boundary of its own.
bool lies_at_rim(const std::bitset<8>& missing, const LatticeCoordinates& cell) {
  for (int block = 1; block < 8; ++block)
    if (missing[static_cast<std::size_t>(block)] && cell_reaches(cell, block)) return true;
  return false;
}

// Cell `number` of an octant (4³ of them), as a place in the octant's leaf.
LatticeCoordinates tested_cell(int octant, int number) {
  return moved(first_place_of_octant(octant), {number / 16, number / 4 % 4, number % 4});
}

Vector3 value_at(const NodeBlock& block, int node) {
  return {block[0][node], block[1][node], block[2][node]};
}

Points tested_points(const Lattice& lattice, const LeafCoordinates* octants, std::size_t count) {
  Points x(3, static_cast<Eigen::Index>(count * tested_nodes));
  for (std::size_t n = 0; n < count; ++n)
    for (int number = 0; number < tested_nodes; ++number)
      x.col(static_cast<Eigen::Index>(n * tested_nodes) + number) =
          lattice(moved(first_node(octants[n]), tested_node(number)));
  return x;
}

}  // namespace

OctantRefinement::OctantRefinement(const ElasticMap& map, const RefinementOptions& options,
                                   const Progress& progress)
    : map_(map), affine_(map.affine()), support_(map.support()), options_(options), progress_(progress) {}

std::vector<FailingOctant> OctantRefinement::failing_octants(const SampledLevels& levels, std::size_t level,
                                                             std::size_t first) {
  std::vector<LeafCoordinates> octants = octants_in_question(levels, level, first);
  std::erase_if(octants, [&](const LeafCoordinates& octant) { return levels.has(level + 1, octant); });
  std::vector<double> errors(octants.size());
  for (std::size_t begin = 0; begin < octants.size(); begin += octants_per_call) {
    const std::size_t count = std::min(octants_per_call, octants.size() - begin);
    progress_.check();
    const Points exact = map_.displacement(tested_points(levels.lattice(level + 1), &octants[begin], count));
    parallel_for(count, 16, [&](std::size_t from, std::size_t to) {
      for (std::size_t n = from; n < to; ++n)
        errors[begin + n] =
            error_in(levels, level, octants[begin + n],
                     exact.middleCols<tested_nodes>(static_cast<Eigen::Index>(n * tested_nodes)));
    });
    evaluated_points_ += count * tested_nodes;
  }
  std::vector<FailingOctant> failing;
  for (std::size_t n = 0; n < octants.size(); ++n)
    if (!(errors[n] <= test_margin * options_.tolerance)) failing.push_back({octants[n], errors[n]});
  return failing;
}

// All octants but those whose residuals say that the error is far below the tolerance.
std::vector<LeafCoordinates> OctantRefinement::octants_in_question(const SampledLevels& levels,
                                                                   std::size_t level,
                                                                   std::size_t first) const {
  const std::vector<LeafCoordinates>& leaves = levels[level].leaves;
  const LeafTable unresolved = unresolved_leaves(levels, level);
  std::vector<std::uint8_t> asked(leaves.size() - first);
  parallel_for(asked.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n)
      asked[n] = level == 0 || unresolved.find(leaves[first + n]) != no_leaf
                     ? 0xFF
                     : octants_of_large_residuals(levels, level, first + n);
  });
  std::vector<LeafCoordinates> octants;
  for (std::size_t n = 0; n < asked.size(); ++n)
    for (int octant = 0; octant < 8; ++octant)
      if (asked[n] >> octant & 1) octants.push_back(child_of(leaves[first + n], octant));
  return octants;
}

// One bit an octant: at some node the interpolated sum of the levels above misses the value by more than the
// tolerance.
std::uint8_t OctantRefinement::octants_of_large_residuals(const SampledLevels& levels, std::size_t level,
                                                          std::size_t leaf) const {
  const SampledLevel& sampled = levels[level];
  NodeBlock coarse;
  levels.coarse_sum_at(level, sampled.leaves[leaf], coarse);
  Points x(3, leaf_nodes), sum(3, leaf_nodes), exact(3, leaf_nodes);
  for (int node = 0; node < leaf_nodes; ++node) {
    const LatticeCoordinates place = place_of_number(node);
    x.col(node) = sampled.lattice(moved(first_node(sampled.leaves[leaf]), place));
    sum.col(node) = value_at(coarse, number_in_block(place));
    exact.col(node) =
        Eigen::Map<const Eigen::Vector3f>(sampled.samples[leaf]->data() + 3 * node).cast<double>();
  }
  const Eigen::VectorXd errors = errors_at(x, sum, exact);
  std::uint8_t octants = 0;
  for (int node = 0; node < leaf_nodes; ++node)
    if (!(errors[node] <= options_.tolerance))
      octants |= static_cast<std::uint8_t>(1 << octant_of_cell(place_of_number(node)));
  return octants;
}

// Leaves near balls of the support that the level does not resolve: small residuals there prove nothing.
LeafTable OctantRefinement::unresolved_leaves(const SampledLevels& levels, std::size_t level) const {
  if (level == 0) return {};
  const Lattice& lattice = levels[level].lattice;
  Support unresolved;
  unresolved.frame = support_.frame;
  for (const BallCloud& cloud : support_.clouds)
    if (cloud.radius < resolving_voxels_per_radius * power_of_two_scale(support_.frame) * lattice.voxel_size)
      unresolved.clouds.push_back(cloud);
  return LeafTable(band_leaves(unresolved, lattice));
}

// Largest error at the octant's tested nodes, where u is `exact`.
double OctantRefinement::error_in(const SampledLevels& levels, std::size_t level,
                                  const LeafCoordinates& octant,
                                  const Eigen::Ref<const Points>& exact) const {
  const LeafCoordinates leaf = parent_of(octant);
  const int number = octant_in_parent(octant);
  NodeBlock sum, refined;
  levels.sum_at(level, leaf, sum);
  refine_block(sum, number, refined);
  const std::bitset<8> missing = levels.missing_in_block(level, leaf);
  Points x(3, tested_nodes), found(3, tested_nodes);
  for (int test = 0; test < tested_nodes; ++test) {
    x.col(test) = levels.lattice(level + 1)(moved(first_node(octant), tested_node(test)));
    found.col(test) = value_at(refined, number_in_block(tested_node(test)));
  }
  const Eigen::VectorXd errors = errors_at(x, found, exact);
  double largest = 0;
  for (int test = 0; test < tested_nodes; ++test) {
    if (missing.any() && lies_at_rim(missing, tested_cell(number, test))) continue;
    largest = std::max(largest, errors[test] + rounding_at(exact.col(test)));
  }
  return largest;
}

// |found − exact|, or of where what follows the map takes the points with these displacements.
Eigen::VectorXd OctantRefinement::errors_at(const Points& x, const Points& found, const Points& exact) const {
  if (!options_.downstream_map) return (exact - found).colwise().norm();
  const Points images = affine_ * x;
  return ((*options_.downstream_map)(images + exact) - (*options_.downstream_map)(images + found))
      .colwise()
      .norm();
}

// Rounding error of u as stored where no finer leaf corrects it; that of the quantum is within test_margin.
double OctantRefinement::rounding_at(const Vector3& u) const {
  if (options_.precision == ValuePrecision::single) return 0;
  constexpr double half_of_last_bit = 0x1p-12;
  return half_of_last_bit * u.norm();
}

}  // namespace bespoke
