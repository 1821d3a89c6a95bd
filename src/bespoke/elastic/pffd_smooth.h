#pragma once

#include <memory>

#include "bespoke/mapping/elastic_map.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

class ExactMapReader;
class ExactMapWriter;

/// p-FFD (IV.E) as a continuous function: E(x) blends the affine maps of the faces near x (frames as PffdMap)
/// with weights area · (1 − s)³ / s², s = (distance / λ)², and the least-squares affine map of the vertices
/// with a constant weight, which E joins continuously at λ. On the source surface E is exactly the piecewise
/// linear map onto the fitted one; the gradient there is the mean of the touching faces'.
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
