#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "bespoke/elastic/elastic_methods.h"
#include "bespoke/flow/surface_path.h"
#include "bespoke/mapping/elastic_chain.h"
#include "bespoke/progress.h"
#include "bespoke/registration/elastic_pairs.h"

namespace bespoke {

/// So many steps are planned at most; those that fold may be halved beyond.
inline constexpr std::size_t max_planned_steps = 32;

/// More steps than these mean that no size of steps keeps a chain from folding.
inline constexpr std::size_t max_useful_steps = 24;

/// A path of surfaces and the times that divide it into the steps of a chain. Every step is as it would be
/// between models of about one size: the powers of two by which the fitted source is larger are left to equal
/// factors of growth in equal times.
struct StepPlan {
  /// Of the source, with anchors off its surface as loose vertices, to the fitted source without its powers
  /// of two.
  std::shared_ptr<const SurfacePath> path;
  std::vector<double> times;         ///< increasing, 0 first, 1 last: one more than there are steps
  double size_scale = 1;             ///< of the fitted source's growth (power_of_two_scale, triangle_mesh.h)
  Vector3 middle = Vector3::Zero();  ///< where growing leaves space in place, mesh units

  std::size_t steps() const { return times.size() - 1; }
  double size(double t) const;  ///< how many times as large as the source the surface is, except for its pose
  Points surface(double t) const;  ///< 3×n, t in [0, 1]: source at 0, fitted source at 1
};

/// Equal steps along a path.
std::vector<double> equal_times(int steps);

/// Equal steps. pairs: of the source and its fitted vertices, the anchors off the surface at their end.
/// Throws InvalidInput where one surface looks out of what it encloses and the other into it.
StepPlan plan_steps(const TriangleMesh& source, const Points& fitted, const ElasticPairs& pairs, int steps);

/// The plan with a step halved.
StepPlan halved(const StepPlan& plan, std::size_t step);

struct ElasticSteps {
  std::vector<std::shared_ptr<const ElasticMap>> maps;
  std::vector<ElasticFindings> found;
  std::vector<Points> sources;     ///< 3×n, where the source's vertices are when a step begins, mesh units
  std::vector<double> times = {};  ///< of the plan, with those of halved steps; empty for halves
};

/// Whether cells at their bounds held finite elements up on their coarsest level.
bool is_blocked(const ElasticFindings& found);

/// How steps are fitted.
struct StepMethod {
  ElasticMethod method;
  ElasticOptions options;
  /// Steps in which cells at their bounds hold finite elements up are halved once: motion is too large for
  /// them. Where that does not help, places give way.
  bool halve_blocked = false;
};

/// One elastic map per step. Each starts from where the maps before it have left the points, so that what
/// they missed is made good by those after them, and its affine part is a similarity: least-squares affine
/// maps of a changing pose shear the space around the model.
ElasticSteps fit_elastic_steps(const TriangleMesh& source, const ElasticPairs& pairs, const StepPlan& plan,
                               const StepMethod& method, const Progress& progress = {});

/// A step of a plan that was `halved` there.
struct HalvedStep {
  const StepPlan& plan;
  const ElasticChain& chain;  ///< the maps of the plan before
  std::size_t step = 0;
};

/// Two maps for one. The second ends where that of the whole step did, so that the steps after it remain as
/// they are.
ElasticSteps fit_halves(const TriangleMesh& source, const ElasticPairs& pairs, const HalvedStep& halves,
                        const StepMethod& method, const Progress& progress = {});

}  // namespace bespoke
