#pragma once

#include <memory>
#include <string>

#include "bespoke/fitting/fit_mapping.h"

namespace bespoke {

/// The bytes from which read_exact_map makes the same map again: centres and coefficients of the radial
/// methods, the two meshes of p-FFD (which its map is made of: `source`, `fitted_vertices`, `lambda`). Little
/// endian, doubles as they are. Throws InvalidInput for a map of another type.
std::string write_exact_map(const ElasticMap& map, const TriangleMesh& source, const Points& fitted_vertices,
                            double lambda);

/// Throws FormatError when the bytes are not what write_exact_map makes.
std::shared_ptr<const ElasticMap> read_exact_map(const std::string& bytes);

}  // namespace bespoke
