#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bespoke/mapping/elastic_map.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/progress.h"
#include "bespoke/statistics.h"

namespace bespoke {

/// Nearest-rank percentiles of a sample whose small values matter as much as its large ones. All zero when
/// `count` is 0.
struct Spread {
  std::size_t count = 0;
  double min = 0;
  double p1 = 0;
  double median = 0;
  double p99 = 0;
  double max = 0;
};

/// Throws InvalidInput on a non-finite value.
Spread spread(std::vector<double> values);

/// "min 0.1 p1 0.2 median 0.3 p99 0.4 max 0.5", four significant digits.
std::string to_string(const Spread& spread);

/// What a map does to space near its source, from the singular values s₁ ≥ s₂ ≥ s₃ ≥ 0 of ∇E at points where
/// u ≠ 0. The rigid part of a mapping changes none of these. No unit.
struct MapDistortion {
  std::size_t samples = 0;  ///< 0 of a map that is affine: the values are those of its affine part, once
  Spread conformal;         ///< s₁ / s₃, 1 where angles are kept; points with s₃ = 0 are left out
  Spread area;              ///< s₁ s₂, the largest factor of an area
  Spread volume;            ///< det ∇E, negative where the map is turned inside out
  double min_determinant = 0;
  std::size_t flips = 0;  ///< samples with det ∇E ≤ 0
};

struct MapDistortionOptions {
  /// About as many are spread evenly over boxes around the support, > 0; those where u = 0 do not count.
  std::size_t samples = 200000;
};

/// Throws InvalidInput when the options are not valid or the map's support is not finite.
MapDistortion map_distortion(const ElasticMap& map, const MapDistortionOptions& options = {},
                             const Progress& progress = {});

/// Faces that the map flips: the direction into which ∇E at the face's centre takes its normal lies
/// behind its image. Faces without area are none. `mapped`: 3×n, E at the mesh's vertices.
std::size_t flipped_faces(const TriangleMesh& mesh, const Points& mapped, const ElasticMap& map);

/// What a deformation does to a mesh itself. No unit but degrees for angles.
struct MeshDistortion {
  Spread edge_length;              ///< length after by length before, one value an edge
  Statistics angle;                ///< |change| of the faces' angles, degrees
  std::size_t left_out_edges = 0;  ///< of no length before
  std::size_t left_out_faces = 0;  ///< without area before or after
};

/// `after`: 3×n, the mesh's vertices after. Throws InvalidInput when the sizes differ.
MeshDistortion mesh_distortion(const TriangleMesh& before, const Points& after);

}  // namespace bespoke
