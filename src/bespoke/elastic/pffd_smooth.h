#pragma once

#include <memory>

#include "bespoke/mapping/elastic_map.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

class ExactMapReader;
class ExactMapWriter;

/// p-FFD (IV.E) with weights that make it a continuous function of position: every source face carries the
/// affine map of its frame (corner, two edges, normal scaled by the square root of the area ratio) onto the
/// fitted face, and E(x) blends the faces near x with weights area · (1 − s)³ / s², s = (distance / λ)², that
/// grow without bound on the face and fall to zero at distance λ; the least-squares affine map of the
/// vertices takes part with a constant weight, so that E joins it continuously at λ. On the source surface E
/// is the piecewise linear map onto the fitted one, exactly; there the gradient is the mean of the touching
/// faces'.
class SmoothPffdMap : public ElasticMap {
 public:
  /// source: reference; fitted: 3×n, its vertices on the target (source frame); lambda > 0, mesh units.
  /// Faces without area in the source take no part. Throws InvalidInput.
  SmoothPffdMap(const TriangleMesh& source, const Points& fitted, double lambda);
  ~SmoothPffdMap() override;

  AffineMap affine() const override;
  Points displacement(const Points& x) const override;
  Points displacement_gradient(const Points& x) const override;
  Support support() const override;

  const TriangleMesh& source() const { return source_; }
  const Points& fitted() const { return fitted_; }  ///< 3×n, mesh units
  double lambda() const { return lambda_; }         ///< mesh units

 private:
  struct Frames;
  template <class Take>
  void for_each_neighbourhood(const Points& x, const Take& take) const;

  TriangleMesh source_;
  Points fitted_;
  double lambda_;
  std::unique_ptr<const Frames> frames_;
};

/// Its bytes (exact_map_io.h). Reading throws FormatError.
void write_exact(const SmoothPffdMap& map, ExactMapWriter& writer);
std::shared_ptr<const SmoothPffdMap> read_pffd_smooth(ExactMapReader& reader);

}  // namespace bespoke
