#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/clearance/obstacle.h"
#include "bespoke/clearance/prepared_product.h"
#include "bespoke/statistics.h"

namespace bespoke {

/// Where a corrected product still misses its distance.
struct MissedPlace {
  std::string obstacle;
  Vector3 place = Vector3::Zero();  ///< on the corrected product, target frame
  double missing = 0;               ///< of the worst sample, mesh units
  std::size_t samples = 0;          ///< that miss nearest to it
  /// From the obstacle, of the places around it no farther than 1.5 times what is missing: the largest, mesh
  /// units. Nothing of layers.
  std::optional<double> space = {};
  /// Whether that is as much as it needs: then what it is joined to holds it, or it was carried too deep.
  bool has_space = false;
};

/// Where faces of a corrected product pass through others that they did not pass through before.
struct PassedThrough {
  std::string other;                ///< the layer's name, or "itself"
  Vector3 place = Vector3::Zero();  ///< on the corrected product, target frame
  std::size_t pairs = 0;            ///< of faces, nearest to it
};

/// Pairs of faces of a product and of a layer below it that pass through each other.
struct LayerPairs {
  std::size_t before = 0;  ///< on the source: left as they are
  std::size_t after = 0;   ///< that were none on the source
};

/// Samples that miss what is required of them by more than the tolerance.
struct MissedDistances {
  std::size_t samples = 0;   ///< of all that were looked at
  std::size_t inside = 0;    ///< of these, inside although they were outside
  std::size_t breaches = 0;  ///< those, and what is short of a required ease
  double most = 0;           ///< mesh units
};

struct ClearanceSummary {
  std::size_t vertices = 0;
  std::size_t looked_at = 0;  ///< samples: vertices, edges and 16 a face
  MissedDistances before, after;
  std::vector<MissedPlace> places;  ///< the worst first, ten at most
  std::size_t moved = 0;            ///< vertices
  Statistics moves;                 ///< of the moved vertices, mesh units
  double largest_bystander = 0;     ///< move of a vertex that missed nothing and is tied to none, mesh units
  /// Of the edges: |ln (length after / length on the source)|, with the growth of the product's whole area
  /// taken out, as carried and as corrected.
  Statistics strain_before, strain_after;
  /// Pairs of faces that pass through each other, and did not as carried.
  std::size_t new_self_intersections = 0;
  std::vector<PassedThrough> passed_through;  ///< itself or a layer, the most pairs first, ten at most
  std::vector<LayerPairs> layers;             ///< with each layer among the obstacles, in their order
  double solve_seconds = 0;                   ///< of the correction, parting faces and drawing near with it
  double check_seconds = 0;                   ///< of what was looked at before and afterwards

  /// Nothing is inside that was outside or short of a required ease, nothing passes through itself that did
  /// not before. What is short of the distance that it had, where there is no space, is listed and allowed.
  bool is_clear() const { return after.breaches == 0 && new_self_intersections == 0; }
};

/// Three lines or more.
std::string to_string(const ClearanceSummary& summary);

struct ClearedProduct {
  Points vertices;  ///< 3×n, target frame
  ClearanceSummary summary;
};

/// The carried product (3×n, target frame) with the smallest smooth correction after which no sample misses
/// the distance that an obstacle requires, beyond its tolerance:
///   min over u of ½ ∫ |u − ℓ² Δu|²   such that   d(x + u) ≥ r(x) at every vertex, edge and face sample
/// linearised in turn (detail/smooth_correction.h). What lies five edges and more from every sample that
/// misses keeps its bits; what misses nothing, and is not tied to what does, moves by 0.2 % of the diagonal
/// at most. Parts that keep their shape are shifted as a whole; vertices at one position stay at one.
/// Constraints that contradict each other end in a compromise and are listed. Throws InvalidInput for sizes
/// that differ and values that are not finite.
ClearedProduct keep_clear(const PreparedProduct& product, const Points& carried,
                          const std::vector<Obstacle>& obstacles);

}  // namespace bespoke
