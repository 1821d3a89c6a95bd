#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "bespoke/lattice/pyramid.h"
#include "bespoke/mapping/elastic_map.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/progress.h"

namespace bespoke {

/// `count` points of the leaves' cells, as many in one leaf as in another, in the leaves' order; the same for
/// the same seed. 3×count, mesh units.
Points random_points(const Lattice& lattice, const std::vector<LeafCoordinates>& leaves, std::size_t count,
                     std::uint64_t seed);

/// A finest cell: the lower node of the finest level that has a leaf there.
struct FinestCell {
  int level = 0;
  LatticeCoordinates node{};

  auto operator<=>(const FinestCell&) const = default;
};

/// The finest cells that hold a column of `at` (3×n, mesh units), each once, in lattice order; a column
/// outside all leaves gives its cell of level 0.
std::vector<FinestCell> finest_cells_at(const Pyramid& pyramid, const Points& at);

/// The finest cells that the surface passes through, each once, in lattice order: up to some that it only
/// grazes. Cells outside all leaves are none. `surface` in the source frame, mesh units.
std::vector<FinestCell> finest_cells_on(const Pyramid& pyramid, const TriangleMesh& surface);

/// An equal number of points in each cell, 27 at most, each in another of its 3³ parts; where there are more
/// cells than points, one in every so many cells. At most `count`, the same for the same seed. Mesh units.
Points points_in_cells(const Pyramid& pyramid, const std::vector<FinestCell>& cells, std::size_t count,
                       std::uint64_t seed);

/// |baked(x) − exact(x)| at each column of x, mesh units; both must have the same affine part. With `then`,
/// of where it takes the two.
std::vector<double> displacement_errors(const ElasticMap& baked, const ElasticMap& exact, const Points& x,
                                        const Progress& progress, const ElasticMap* downstream_map = nullptr);

}  // namespace bespoke
