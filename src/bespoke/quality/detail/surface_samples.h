#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// Points spread over a surface, each known by its face, so that they can follow a deformation.
struct SurfaceSamples {
  std::vector<int> faces;  ///< in increasing order
  Points barycentric;      ///< 3×(number of samples): weights of the face's vertices
};

/// `count` points, stratified by area: each stands for the same share of it, and a face of k shares holds at
/// least ⌊k⌋ − 1 of them. No randomness: the same mesh gives the same samples. A mesh without area gives
/// none.
SurfaceSamples sample_surface(const TriangleMesh& mesh, std::size_t count);

/// 3×(number of samples): where the samples are, on a mesh of the same faces. Mesh units.
Points positions(const SurfaceSamples& samples, const TriangleMesh& mesh);

}  // namespace bespoke
