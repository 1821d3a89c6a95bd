#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/anchors/anchors.h"
#include "bespoke/mapping/elastic_chain.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/pipeline/elastic_steps.h"
#include "bespoke/registration/fit_options.h"

namespace bespoke {

/// Early signs that no useful map follows from a fit.
struct MapHealth {
  std::size_t steps = 1;
  /// Determinants of ∇E at places on the source, over the cube of the whole surface's growth: one in twenty
  /// is below `low`.
  double low = 1;

  /// Volumes shrunk by more than the storage of maps resolves, or a chain that no size of steps keeps from
  /// folding.
  bool is_unusable() const;
};

/// Throws SolverError with the reason where a chain is planned with more steps, before any of them is fitted.
/// Not where the number of steps is given.
void require_useful_steps(std::size_t steps, const FitOptions& options);

/// The ratio of the singular values of a face's deformation (1: its angles are kept) that one part in twenty
/// of the surface's area exceeds; against the source as it is or moved by the affine map nearest to the
/// deformation, whichever is less. fitted: 3×n, the vertices of `source` after. 1 for a source without area.
double surface_shear(const TriangleMesh& source, const Points& fitted);

/// Throws SolverError with the reason where a registered source is sheared by more than the largest stretch
/// of the surface fitting: before any map is fitted to it. For methods as require_usable.
void require_usable_surface(const TriangleMesh& source, const Points& fitted, const FitOptions& options);

/// Of an exact map, at some hundred vertices. source: as it was fitted; fitted: 3×n, H'_a, source frame.
MapHealth map_health(const ElasticChain& elastic, const TriangleMesh& source, const Points& fitted);

/// Throws SolverError with the reason where no useful map follows from the fit: before it is baked, and
/// before steps of it are divided. Only of methods that keep the orientation, and where the number of steps
/// is not given: others fold by nature, or were requested.
void require_usable(const ElasticChain& elastic, const TriangleMesh& source, const Points& fitted,
                    const FitOptions& options);

/// Throws SolverError where half of the pairs that have neither a σ above 0 nor a weight are missed by more
/// than a tenth of what the targets span: these pairs have no map. residuals: one a pair, mesh units. Not
/// for fewer than four such pairs, and not where the number of steps is given.
void require_met_anchors(const Anchors& anchors, const std::vector<double>& residuals,
                         const FitOptions& options);

}  // namespace bespoke
