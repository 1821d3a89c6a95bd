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

/// Where a face turned or was stretched or squeezed by more than the limits of the settings since before, or
/// is bent by more than a right angle at an edge at which it is not in the shape, its vertices give up their
/// displacements and take the mean of their neighbours' (harmonic along the edges), in as many rings around
/// the face as help and the settings allow, and as long as that is a small part of the vertices: where more
/// has turned, repair would undo the fit. By as much as a face comes nearer to the surface around it, that
/// of its corners' normals, it has not turned: the fit smooths what is folded on the source. A patch of
/// such vertices stays as it was drawn, turned and stretched, where following would bend it farther from its
/// shape (the sum of the squared bends of its edges, bends.h): there it is the smooth deformation that is
/// folded, a nostril inside out, and measures nothing. Throws SolverError.
RepairedSurface repair_misoriented_faces(const DrawnSurface& surface,
                                         const FaceRepairSettings& settings = {});

/// The larger of the largest factor by which a length in a face grew, and by which one shrank; 1 for a face
/// that had no area. before, after: 3×n, mesh units.
double face_stretch(const Faces& faces, Eigen::Index face, const Points& before, const Points& after);

}  // namespace bespoke
