#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/quality/distortion.h"
#include "bespoke/quality/signed_distance.h"

namespace bespoke {

/// Where a product lies inside of the body that it is worn on.
struct Penetration {
  std::size_t vertices = 0;  ///< deeper than the tolerance
  double area_share = 0;     ///< of the product's surface, in [0, 1], from samples
  double line_share = 0;     ///< of the length of its lines, in [0, 1], from samples
  double deepest = 0;        ///< of vertices and samples, mesh units, ≥ 0
};

/// What of a product lies inside of the target although it was not inside of the source, and came nearer by
/// more than 0.1 % of the target's diagonal: what lies on a surface is to either side of it.
struct NewPenetration {
  /// Of its area, from samples; without faces of the length of its lines; of its vertices where it has
  /// neither. In [0, 1].
  double share = 0;
  double deepest = 0;  ///< of these places, mesh units, ≥ 0

  /// Worth a warning: what a garment's hems and a body's floats leave stays far below.
  bool is_notable() const { return share > 0.02; }
};

/// "7.1 % of it lies inside the target, though not inside the source before, at most 0.8 deep; …", and what
/// to do about it.
std::string to_string(const NewPenetration& new_penetration);

/// What carrying a product across did to it and to its fit.
struct ProductQuality {
  std::size_t vertices = 0;
  std::size_t faces = 0;  ///< triangles
  std::size_t lines = 0;  ///< edges of polylines
  MeshDistortion distortion;
  Spread line_lengths;  ///< of these edges, after by before
  /// Signed distance of the vertices from the body, mesh units, positive outside, over those whose side is
  /// known before and after.
  Spread clearance_before;      ///< from the source
  Spread clearance_after;       ///< from the target
  Statistics clearance_change;  ///< |after − before|: kept within p95 for 95 % of the vertices, and so on
  std::size_t unsided_vertices = 0;  ///< nearest to a boundary of the body before or after, so left out
  Penetration penetration_before;
  Penetration penetration_after;
  NewPenetration new_penetration;
  std::size_t self_intersections_before = 0;  ///< pairs of faces, see self_intersections
  std::size_t self_intersections_after = 0;
};

struct ProductQualityOptions {
  std::size_t samples = 50000;       ///< on the product's surface
  std::size_t line_samples = 10000;  ///< on its lines
  /// What counts as inside, as a fraction of the body's bounding-box diagonal: below it, rounding of the
  /// files' floats decides.
  double inside_tolerance = 1e-6;
};

/// The two bodies that a product is measured against.
struct Bodies {
  const TriangleMesh& source;
  const TriangleMesh& target;
  const SignedDistance& from_source;  ///< of `source`
  const SignedDistance& from_target;  ///< of `target`
};

/// A product on the source.
struct MeasuredProduct {
  MeasuredProduct(TriangleMesh faces, std::vector<int> lines = {})
      : mesh(std::move(faces)), line_edges(std::move(lines)) {}

  TriangleMesh mesh;
  std::vector<int> line_edges;  ///< the ends of the edges of its polylines, by twos
};

/// `after`: 3×n, the product's vertices on the target, target frame. A product without faces has no
/// distortion of these, samples on them or self-intersections. Throws InvalidInput when the sizes differ or a
/// value is not finite.
ProductQuality product_quality(const MeasuredProduct& before, const Points& after, const Bodies& bodies,
                               const ProductQualityOptions& options = {});

/// Of it the new penetration alone. Throws as product_quality.
NewPenetration product_new_penetration(const MeasuredProduct& before, const Points& after,
                                       const Bodies& bodies, const ProductQualityOptions& options = {});

}  // namespace bespoke
