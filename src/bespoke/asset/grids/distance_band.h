#pragma once

#include <functional>
#include <vector>

#include "bespoke/asset/grids/stored_grid.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// Of a distance grid's metadata: p99 of its amount at the model's surface, mesh units.
inline constexpr const char* distance_error_key = "bespoke:error_p99";

/// Signed distance of the mesh as a narrow band of the size of source_distance's (a voxel is 1/128 of the
/// diagonal, three voxels to each side), nameless; `distance` gives it at points (3×n). Every node of a leaf
/// has its value, cut off at the band.
StoredGrid signed_band(const TriangleMesh& mesh,
                       const std::function<std::vector<double>(const Points&)>& distance);

/// The leaves that a band encloses without storing them: missing ones that cannot be reached from outside,
/// and whose neighbours' nodes are inside.
std::vector<LeafCoordinates> enclosed_leaves(const StoredGrid& band);

/// Points on the surface, where its distance is 0: the centres of its faces and its vertices, evenly thinned
/// to some ten thousand.
Points surface_probes(const TriangleMesh& mesh);

}  // namespace bespoke
