#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/surface_fit/deformation_graph_settings.h"

namespace bespoke {

/// A surface that a smooth deformation has brought to a place, and then was drawn farther. Mesh units.
struct DrawnSurface {
  const Points& shape;         ///< 3×n, where it came from: as it is meant to bend
  const TriangleMesh& before;  ///< as the smooth deformation left it
  const Points& after;         ///< 3×n, as it was drawn
};

/// A surface whose turned faces were reset.
struct RepairedSurface {
  Points vertices;                      ///< 3×n, mesh units
  std::size_t repaired_vertices = 0;    ///< vertices that follow their neighbours
  std::vector<int> stretched_vertices;  ///< of those, by index: corners of faces that were stretched too far
  std::size_t misoriented_faces = 0;    ///< faces still turned
};

/// Resets faces that are turned, stretched or squeezed beyond the settings since before, or newly bent by
/// more than a right angle at an edge, to a harmonic extension of the displacements around, in as many rings
/// as help and the settings allow. A face that approaches the surface around it (its corners' normals) has
/// not turned. Patches that this would bend farther from their shape (bends.h) stay, as does all where too
/// much is misoriented. Throws SolverError.
RepairedSurface repair_misoriented_faces(const DrawnSurface& surface,
                                         const FaceRepairSettings& settings = {});

/// The larger of the largest factor by which a length in a face grew, and by which one shrank; 1 for a face
/// that had no area. before, after: 3×n, mesh units.
double face_stretch(const Faces& faces, Eigen::Index face, const Points& before, const Points& after);

}  // namespace bespoke
