#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "bespoke/progress.h"
#include "bespoke/statistics.h"
#include "bespoke/types.h"

namespace bespoke {

/// A map as a function of the columns of a 3×n matrix, mesh units.
using PointFunction = std::function<Points(const Points&)>;

/// What moves a point, on the nodes of a regular grid: node (i, j, k) lies at origin + spacing · (i, j, k).
struct DisplacementImage {
  Vector3 origin = Vector3::Zero();  ///< mesh units
  double spacing = 0;                ///< mesh units
  std::array<std::size_t, 3> size{};
  std::vector<float> values;  ///< three a node, mesh units, i runs fastest

  /// Trilinear between the nodes, at the columns of x (3×n, mesh units), which lie between them.
  Points operator()(const Points& x) const;
};

/// image(x) − x on the nodes of the smallest grid around the box whose origin is its lower corner. Throws
/// InvalidInput for a spacing that is not positive or an empty box; MemoryLimitError, naming a spacing that
/// fits, when the values take more than `max_memory` bytes; Interrupted.
DisplacementImage sample_displacements(const PointFunction& image, const Box& box, double spacing,
                                       std::size_t max_memory, const Progress& progress = {});

/// |what the image makes of x − image(x)| at so many random points (> 0) of the box, which the grid covers,
/// mesh units: the same points for the same box. `max` is also over as many more, within half a voxel of the
/// worst hundredth.
Statistics sampling_error(const DisplacementImage& sampled, const PointFunction& image, const Box& box,
                          std::size_t points, const Progress& progress = {});

}  // namespace bespoke
