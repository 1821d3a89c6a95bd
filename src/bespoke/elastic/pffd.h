#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bespoke/elastic/elastic_fit.h"
#include "bespoke/mapping/elastic_map.h"

namespace bespoke {

class ExactMapReader;
class ExactMapWriter;

/// What p-FFD has to say of a fit: it solves nothing. Of both forms.
struct PffdSummary {
  std::size_t faces = 0;
};

/// One line.
std::string to_string(const PffdSummary& summary);
std::vector<Figure> figures(const PffdSummary& summary);

/// The paper's p-FFD as printed (IV.E, Eq. 18): E(x) is the mean of the affine maps of the faces whose centre
/// is within 1.5 times the nearest centre's distance, with weights 1/(1e-8 + d³), d in mesh units. A face's
/// map carries its frame (corner, two edges, normal scaled by the root of the area ratio) onto the fitted
/// face's. Beyond λ E is the least-squares affine map of the vertices. E jumps there and where faces enter or
/// leave the mean; its gradient is that between jumps. SmoothPffdMap is the form without jumps.
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

  const TriangleMesh& source() const { return source_; }
  const Points& fitted() const { return fitted_; }  ///< 3×n, mesh units
  double lambda() const { return lambda_; }         ///< mesh units

 private:
  struct Faces;

  TriangleMesh source_;
  Points fitted_;
  double lambda_;
  std::unique_ptr<const Faces> faces_;
};

/// Its bytes (exact_map_io.h). Reading throws FormatError.
void write_exact(const PffdMap& map, ExactMapWriter& writer);
std::shared_ptr<const PffdMap> read_pffd(ExactMapReader& reader);

}  // namespace bespoke
