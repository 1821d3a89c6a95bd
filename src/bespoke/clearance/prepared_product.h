#pragma once

#include <memory>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// A product as it lies on the source, with what corrections on every target need of it: its places and
/// shells, the factored energy, its samples. Made once a product; any number of threads may share one.
class PreparedProduct {
 public:
  /// `mesh`: the product, source frame; without faces, points that move alone. `parts`: for each vertex the
  /// number of the part that keeps its shape, or -1; or empty. `lines`: 2×l vertex numbers, further edges.
  /// Throws InvalidInput for sizes that do not fit and for coordinates that are not finite, SolverError.
  explicit PreparedProduct(TriangleMesh mesh, const std::vector<int>& parts = {},
                           const Eigen::Matrix2Xi& lines = Eigen::Matrix2Xi(2, 0));
  ~PreparedProduct();
  PreparedProduct(PreparedProduct&&) noexcept;
  PreparedProduct& operator=(PreparedProduct&&) noexcept;

  const TriangleMesh& mesh() const;

  struct Data;
  const Data& data() const { return *data_; }

 private:
  std::unique_ptr<const Data> data_;
};

}  // namespace bespoke
