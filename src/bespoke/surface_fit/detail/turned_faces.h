#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/surface_fit/deformation_graph_settings.h"
#include "bespoke/surface_fit/detail/unfolded_parts.h"

namespace bespoke {

/// A surface whose turned faces were taken back.
struct MendedSurface {
  Points vertices;                      ///< 3×n, mesh units
  std::size_t mended_vertices = 0;      ///< vertices that follow their neighbours
  std::vector<int> stretched_vertices;  ///< of those, by index: corners of faces that were stretched too far
  std::size_t turned_faces = 0;         ///< faces still turned, but for those of parts that were unfolded
};

/// Where a face turned or was stretched or squeezed by more than the limits of the settings since before, its
/// vertices give up their displacements and take the mean of their neighbours' (harmonic along the edges), in
/// as many rings around the face as help and the settings allow, and as long as that is a small part of the
/// vertices: where more has turned, mending would undo the fit. By as much as a face comes nearer to the
/// surface around it, that of its corners' normals, it has not turned: the fit smooths what is crumpled on
/// the source. Parts that were folded before and are so no longer are left as they were drawn
/// (unfolded_parts.h), however far they turned or were stretched since, for a fold measures neither: a
/// nostril that the smooth deformation had turned inside out. Throws SolverError.
MendedSurface mend_turned_faces(const DrawnSurface& surface, const MendingSettings& settings = {});

}  // namespace bespoke
