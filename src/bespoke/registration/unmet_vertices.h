#pragma once

#include <string>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/surface_fit/contact.h"

namespace bespoke {

/// Why a map without folds misses a fitted position.
enum class UnmetReason {
  shared_place,  ///< another vertex at the same place was fitted elsewhere
  touching,      ///< the target touches itself here: the vertex was released (contact.h)
  folded,        ///< a fitted face at the vertex is flipped, or has no area left: the data folds there
  steep,  ///< neighbours part faster than the bounds of the map allow: on squeeze, or on the gradient of
          ///< layers
};

/// "shared place", "the target touches itself", "fitted faces folded", "too steep".
const char* to_string(UnmetReason reason);

struct UnmetVertex {
  int vertex = 0;       ///< of the source
  double residual = 0;  ///< |E(vᵢ) − v'ᵢ|, mesh units
  UnmetReason reason = UnmetReason::steep;
};

/// The vertices in some face whose image lies farther than `tolerance` (≥ 0, mesh units) from their fitted
/// position, by index. images: E(vᵢ), fitted: v'ᵢ, 3×n each, mesh units; released: those whose fitted
/// position is not v'ᵢ, but where they were before. A face counts as folded where its
/// fitted normal and that of its image are 90° apart or more.
std::vector<UnmetVertex> unmet_vertices(const TriangleMesh& source, const Points& images,
                                        const Points& fitted, double tolerance,
                                        const std::vector<ReleasedVertex>& released = {});

/// How many, and how many for which reason; empty when there are none. One line.
std::string to_string(const std::vector<UnmetVertex>& unmet);

}  // namespace bespoke
