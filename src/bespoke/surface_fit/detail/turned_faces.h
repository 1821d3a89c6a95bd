#pragma once

#include <cstddef>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// A face that has turned farther than this against the smooth deformation around it was drawn to the wrong
/// side of a fold.
inline constexpr double most_degrees_turned = 55;

/// A surface whose turned faces were taken back.
struct MendedSurface {
  Points vertices;                  ///< 3×n, mesh units
  std::size_t mended_vertices = 0;  ///< vertices that follow their neighbours
  std::size_t turned_faces = 0;     ///< faces still turned
};

/// `before`: a surface that a smooth deformation has brought here; `after` (3×n, mesh units): where its
/// vertices were drawn then. Where a face turned by more than `most_degrees_turned`, its vertices give up
/// their displacements and take the mean of their neighbours' (harmonic along the edges), in as many rings
/// around the face as it takes, up to eight, and as long as that is at most 5 % of the vertices (or 100):
/// where more has turned, mending would undo the fit. Throws SolverError.
MendedSurface mend_turned_faces(const TriangleMesh& before, const Points& after);

}  // namespace bespoke
