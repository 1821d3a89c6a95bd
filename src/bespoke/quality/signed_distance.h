#pragma once

#include <memory>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// Distance from a surface with the side: positive outside, negative inside. Inside of a closed surface is
/// where the generalised winding number (winding_number.h) is not 0, so that nested shells enclose what is
/// between them. Inside of an open one is where that number exceeds 1/2, and what lies behind the closest
/// point by its angle-weighted normal (Bærentzen, Aanæs 2005), as behind a sheet. Vertices at one position
/// count as one, so that seams do no harm. Queries are thread-safe.
class SignedDistance {
 public:
  /// Throws InvalidInput for a mesh that is not valid.
  explicit SignedDistance(const TriangleMesh& mesh);
  ~SignedDistance();
  SignedDistance(SignedDistance&&) noexcept;
  SignedDistance& operator=(SignedDistance&&) noexcept;

  struct Values {
    std::vector<double> distance;  ///< mesh units; its amount is right everywhere
    /// 0 where the closest point lies on a boundary of the surface, or where the normals there cancel: the
    /// distance is not one across the surface, and negative only where the winding number says inside.
    std::vector<char> sided;
  };
  /// At the columns of x (3×n). Parallel inside.
  Values operator()(const Points& x) const;

 private:
  struct Surface;
  std::unique_ptr<const Surface> surface_;
};

}  // namespace bespoke
