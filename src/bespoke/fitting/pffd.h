#pragma once

#include <memory>

#include "bespoke/mapping/elastic_map.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// The paper's p-FFD (IV.E, Eq. 18) as a function of position: every source face carries the affine map of
/// its frame (corner, two edges, normal scaled by the square root of the area ratio) onto the fitted face,
/// and E(x) blends the faces near x with weights that grow without bound on the face and fall to zero at
/// distance λ; the affine part takes part with a constant weight, so that E joins it continuously at λ.
class PffdMap : public ElasticMap {
 public:
  /// source: reference; fitted: 3×n, its vertices on the target (source frame); lambda > 0, mesh units.
  /// Faces without area in the source take no part. Throws InvalidInput.
  PffdMap(const TriangleMesh& source, const Points& fitted, double lambda);
  ~PffdMap() override;

  AffineMap affine() const override;
  Points displacement(const Points& x) const override;
  Points displacement_gradient(const Points& x) const override;
  Support support() const override;

 private:
  struct Frames;
  std::unique_ptr<const Frames> frames_;
};

}  // namespace bespoke
