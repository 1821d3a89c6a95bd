#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/mapping/elastic_map.h"
#include "bespoke/quality/signed_distance.h"
#include "bespoke/types.h"

namespace bespoke {

/// A number for every vertex of a mesh, to be shown as its colour.
struct VertexField {
  std::string id;     ///< in the scene's record
  std::string label;  ///< for a person
  bool is_length = false;
  std::optional<double>
      middle;                  ///< from where colours diverge: 0 of changes, 1 of ratios; none for magnitudes
  std::vector<double> values;  ///< NaN where not known; mesh units, or no unit
};

/// What the elastic part does at vertices. `normals`: unit normals of the surface there, 3×n, zero where
/// there are none, so that stretch is that of the surface (of space, where there is no normal). Fields
/// `displacement`
/// (|E(x) − x|), `largest_stretch`, `smallest_stretch`, `area`, `determinant`.
std::vector<VertexField> deformation_fields(const ElasticMap& elastic, const Points& vertices,
                                            const Points& normals);

/// Signed distance of a product from the source before and from the target after, and its change: fields
/// `clearance_before`, `clearance_after`, `clearance_change`. after: 3×n, in the target frame.
std::vector<VertexField> clearance_fields(const SignedDistance& from_source,
                                          const SignedDistance& from_target, const Points& before,
                                          const Points& after);

/// Signed distance from the target of a product as the map carries it, where it is corrected after that:
/// field `clearance_carried`.
VertexField carried_clearance_field(const SignedDistance& from_target, const Points& carried);

/// How far a correction moves vertices: field `moved`.
VertexField move_field(const Points& carried, const Points& corrected);

/// Unsigned distance of points from a surface.
VertexField distance_field(std::string id, std::string label, const SignedDistance& surface,
                           const Points& points);

}  // namespace bespoke
