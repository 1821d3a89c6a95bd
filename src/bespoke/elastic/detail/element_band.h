#pragma once

#include <vector>

#include "bespoke/lattice/lattice.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/types.h"

namespace bespoke {

/// The nodes within lambda (mesh units) of a surface, which is in the box.
std::vector<LatticeCoordinates> nodes_near(const ClosestPointTree& surface, const Box& box,
                                           const Lattice& lattice, double lambda);

/// Adds those within lambda of a point.
void add_nodes_within(const Lattice& lattice, const Vector3& x, double lambda,
                      std::vector<LatticeCoordinates>& nodes);

/// Adds those of the cells that hold the points (3×n), and of the cells around these.
void add_nodes_of_cells_around(const Lattice& lattice, const Points& points,
                               std::vector<LatticeCoordinates>& nodes);

/// Adds those within two voxels of a point along each axis.
void add_nodes_around(const Lattice& lattice, const Vector3& x, std::vector<LatticeCoordinates>& nodes);

}  // namespace bespoke
