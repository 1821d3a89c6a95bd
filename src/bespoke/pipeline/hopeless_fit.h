#pragma once

#include "bespoke/pipeline/fit_mapping.h"

namespace bespoke {

/// Early signs that no useful map follows from a fit.
struct MapHealth {
  std::size_t steps = 1;
  /// Determinants of ∇E at places on the source, over the cube of the whole surface's growth: one in twenty
  /// is below `low`.
  double low = 1;
  double least = 1;

  /// Volumes shrunk by more than the storage of maps resolves, or a chain that no size of steps keeps from
  /// folding.
  bool is_hopeless() const;
};

/// Of an exact map, at some hundred vertices. source: as it was fitted.
MapHealth map_health(const FittedMapping& fitted, const TriangleMesh& source);

/// Throws SolverError with the reason where the fit is hopeless: before it is baked, and before steps of it
/// are divided. Only of methods that keep the orientation, and where the number of steps is not given: others
/// fold by nature, or were requested.
void require_hopeful(const FittedMapping& fitted, const TriangleMesh& source, const FitOptions& options);

}  // namespace bespoke
