#include "bespoke/pipeline/detail/inverse_elements.h"

#include "bespoke/elastic/finite_elements.h"
#include "bespoke/lattice/pyramid.h"
#include "bespoke/mapping/affine_map.h"

namespace bespoke {
namespace {

// What was squeezed is spread out again, by smaller cells: one level more than a fit has.
constexpr int max_levels = 6;
// Of the tolerance: the fit's, which halves cells where a place is missed by three of it.
constexpr double share_of_tolerance = 1.0 / 3;

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
      KnownSpace{compose(as_affine(frame), compose(inverse(problem.map.affine()), as_affine(inverse(frame)))),
                 there(nodes), frame * nodes};
  return fit_finite_elements(surface.vertices, frame * problem.surface.vertices, surface, elements, progress)
      .map;
}

}  // namespace bespoke
