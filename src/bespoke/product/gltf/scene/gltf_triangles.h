#pragma once

#include <cstdint>
#include <vector>

#include "bespoke/product/gltf/scene/gltf_nodes.h"

namespace bespoke {

/// The triangles of a primitive where a node shows its mesh.
struct GltfTriangles {
  std::size_t shown = 0;               ///< in the scene
  std::size_t primitive = 0;           ///< of the mesh
  std::vector<std::uint32_t> corners;  ///< three vertices a triangle, as the scene shows their front
  Points places;                       ///< of the corners, in the scene
  bool is_mirrored = false;            ///< the mesh has its front where the scene shows its back
};

/// The triangles from behind: their last two corners change places.
void turn_over(std::vector<std::uint32_t>& corners);

/// The edges of a primitive's lines where a node shows its mesh.
struct GltfLines {
  std::size_t shown = 0;            ///< in the scene
  std::size_t primitive = 0;        ///< of the mesh
  std::vector<std::uint32_t> ends;  ///< two vertices an edge
  Points places;                    ///< of the ends, in the scene
};

/// All triangles that the scene shows, in the order of what it shows and of the primitives; those of strips
/// and fans as lists. Throws FormatError naming the JSON pointer at fault, and InvalidInput for triangles
/// that are compressed only.
std::vector<GltfTriangles> shown_triangles(const GltfFile& file, const std::vector<GltfAccessor>& accessors,
                                           const GltfScene& scene);

/// The same of lines; those of loops and strips edge by edge.
std::vector<GltfLines> shown_lines(const GltfFile& file, const std::vector<GltfAccessor>& accessors,
                                   const GltfScene& scene);

}  // namespace bespoke
