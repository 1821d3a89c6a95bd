#include "bespoke/pipeline/detail/inverse_elements.h"

#include <algorithm>
#include <vector>

#include "bespoke/elastic/finite_elements.h"
#include "bespoke/lattice/leaf_table.h"
#include "bespoke/mapping/affine_map.h"

namespace bespoke {
namespace {

// What was squeezed is spread out again, by smaller cells: one level more than a fit has.
constexpr int max_levels = 6;
// Of the tolerance: the fit's, which halves cells where a place is missed by three of it.
constexpr double share_of_tolerance = 1.0 / 3;

bool is_zero(const float* value) { return value[0] == 0 && value[1] == 0 && value[2] == 0; }

/// The nodes of a pyramid that move, each once, by the finest level that has it.
Points moved_nodes(const Pyramid& pyramid) {
  std::vector<Vector3> found;
  LeafTable finer;
  const PyramidLevel* below = nullptr;
  const auto moves_below = [&](const LatticeCoordinates& node) {
    const LatticeCoordinates fine{2 * node[0], 2 * node[1], 2 * node[2]};
    const int leaf = below ? finer.find(leaf_of(fine)) : no_leaf;
    return leaf != no_leaf && !is_zero(below->values_of(static_cast<std::size_t>(leaf)) +
                                       3 * number_of_place(place_in_leaf(fine)));
  };
  for (std::size_t k = pyramid.levels.size(); k-- > 0;) {
    const PyramidLevel& level = pyramid.levels[k];
    for (std::size_t leaf = 0; leaf < level.leaves.size(); ++leaf)
      for (int number = 0; number < leaf_nodes; ++number) {
        const LatticeCoordinates node = moved(first_node(level.leaves[leaf]), place_of_number(number));
        if (is_zero(level.values_of(leaf) + 3 * number) || moves_below(node)) continue;
        found.push_back(pyramid.lattice(static_cast<int>(k))(node));
      }
    finer = LeafTable(level.leaves);
    below = &level;
  }
  Points nodes(3, static_cast<Eigen::Index>(found.size()));
  for (std::size_t i = 0; i < found.size(); ++i) nodes.col(static_cast<Eigen::Index>(i)) = found[i];
  return nodes;
}

}  // namespace

std::shared_ptr<const BakedMap> inverse_elements(const InverseProblem& problem, const InverseFit& options,
                                                 const Progress& progress) {
  const RigidTransform& frame = problem.target_from_source;
  const auto there = [&](const Points& x) { return Points(frame * problem.map(x)); };
  const Points nodes = moved_nodes(problem.map.pyramid());
  const TriangleMesh surface{there(problem.surface.vertices), problem.surface.faces};
  FiniteElementOptions elements;
  elements.lambda = options.lambda;
  elements.fit_tolerance = share_of_tolerance * options.tolerance;
  elements.max_memory = options.max_memory;
  elements.max_levels = max_levels;
  elements.max_nodes = options.max_nodes;
  elements.known =
      KnownSpace{compose(as_affine(frame),
                         compose(inverse(problem.map.affine()), as_affine(inverse(frame)))),
                 there(nodes), frame * nodes};
  return fit_finite_elements(surface.vertices, frame * problem.surface.vertices, surface, elements, progress)
      .map;
}

}  // namespace bespoke
