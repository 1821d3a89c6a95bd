#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/types.h"

namespace bespoke {

/// Points spread over lines, each known by its edge, so that they can follow a deformation.
struct LineSamples {
  std::vector<int> ends;       ///< vertices, two a sample
  std::vector<double> places;  ///< of a sample between its ends, in (0, 1)
};

/// `count` points, at equal distances along all edges one after the other. line_edges: the ends of the edges,
/// by twos; vertices: 3×n. Lines without length give none.
LineSamples sample_lines(const Points& vertices, const std::vector<int>& line_edges, std::size_t count);

/// 3×(number of samples): where the samples are, with these vertices. Mesh units.
Points positions(const LineSamples& samples, const Points& vertices);

}  // namespace bespoke
