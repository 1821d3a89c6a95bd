#pragma once

#include <cstddef>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// A surface whose turned faces were taken back.
struct MendedSurface {
  Points vertices;                  ///< 3×n, mesh units
  std::size_t mended_vertices = 0;  ///< vertices that follow their neighbours
  std::size_t turned_faces = 0;     ///< faces still turned by more than 90°
};

/// `before`: a surface that a smooth deformation has brought here; `after` (3×n, mesh units): where its
/// vertices were drawn then. Where a face turned by more than 90°, its vertices were drawn to the wrong side
/// of a fold: they give up their displacements and take the mean of their neighbours' (harmonic along the
/// edges), in as many rings around the face as it takes, up to eight. Throws SolverError.
MendedSurface mend_turned_faces(const TriangleMesh& before, const Points& after);

}  // namespace bespoke
