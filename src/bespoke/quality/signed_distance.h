#pragma once

#include <memory>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// Distance from a surface with the side: positive on the side that the normals point to (outside of a closed
/// body), negative on the other, by the angle-weighted normal at the closest point (Bærentzen, Aanæs 2005),
/// which is right for every consistently oriented manifold. Vertices at one position count as one, so that
/// seams do no harm. Queries are thread-safe.
class SignedDistance {
 public:
  /// Throws InvalidInput for a mesh that is not valid.
  explicit SignedDistance(const TriangleMesh& mesh);
  ~SignedDistance();
  SignedDistance(SignedDistance&&) noexcept;
  SignedDistance& operator=(SignedDistance&&) noexcept;

  struct Values {
    std::vector<double> distance;  ///< mesh units; its amount is right everywhere
    /// 1 where the side is known; 0 where the closest point lies on a boundary of the surface, so that there
    /// is none, or where the normals there cancel.
    std::vector<char> sided;
  };
  /// At the columns of x (3×n). Parallel inside.
  Values operator()(const Points& x) const;

 private:
  struct Surface;
  std::unique_ptr<const Surface> surface_;
};

}  // namespace bespoke
