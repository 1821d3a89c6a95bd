#include "resampled.h"

#include "bespoke/topology/decimation.h"
#include "bespoke/topology/edge_refinement.h"

namespace bespoke {

TriangleMesh resampled(const TriangleMesh& mesh, Eigen::Index vertices) {
  TriangleMesh fine = mesh;
  while (fine.vertices.cols() < vertices) {
    const double every_edge = 1e-9 * diagonal(fine.vertices);
    fine = refine_long_edges(fine, every_edge, 1).mesh;
  }
  return decimated(fine, 2 * static_cast<std::size_t>(vertices)).mesh;
}

}  // namespace bespoke
