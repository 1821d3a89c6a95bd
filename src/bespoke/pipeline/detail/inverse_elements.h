#pragma once

#include <cstddef>
#include <memory>

#include "bespoke/lattice/baked_map.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/progress.h"
#include "bespoke/rigid/rigid_transform.h"

namespace bespoke {

/// What an inverse of finite elements is fitted to.
struct InverseProblem {
  const BakedMap& map;                       ///< E, a bijection
  const RigidTransform& target_from_source;  ///< Γ
  const TriangleMesh& surface;               ///< the model before E, source frame, mesh units; with faces
};

/// How.
struct InverseFit {
  double lambda = 0;          ///< effective distance around E(surface), > 0, mesh units
  double tolerance = 0;       ///< places that are missed by more halve cells, > 0, mesh units
  std::size_t max_nodes = 0;  ///< > 0
  std::size_t max_memory = std::size_t{8} << 30;  ///< bytes
};

/// Γ∘E⁻¹∘Γ⁻¹ in the target frame (InverseMap, inverse.h) as the map of least distortion that takes the image
/// of every node of E, and of every vertex of the surface, back to where it was: fit_finite_elements. Its
/// affine part is the inverse of E's. Throws as that does.
std::shared_ptr<const BakedMap> inverse_elements(const InverseProblem& problem, const InverseFit& options,
                                                 const Progress& progress = {});

}  // namespace bespoke
