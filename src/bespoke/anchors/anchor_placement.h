#pragma once

#include <optional>
#include <string>

#include "bespoke/anchors/anchors.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// How the anchors of one side lie beside their model, mesh units. Mesh files name no unit, so anchors given
/// in another one show only here.
struct AnchorPlacement {
  double median_distance = 0;  ///< of the anchors from the surface
  double anchor_diagonal = 0;  ///< of the anchors' bounding box
  double model_diagonal = 0;

  /// Anchors may lie off the surface, but hardly half of them by more than a quarter of their own spread or
  /// of the model: scaling either by an inch (2.54) about a common centre takes them that far. Anchors all
  /// at one place, or a single one, have no spread.
  bool is_far() const;
};

/// `anchors`: 3×n. All zero without anchors. Throws InvalidInput when the mesh has no faces or something is
/// not finite.
AnchorPlacement anchor_placement(const TriangleMesh& model, const Points& anchors);

/// That of anchors which are far. Those near vertices are told without a tree of closest points. Throws as
/// anchor_placement.
std::optional<AnchorPlacement> far_placement(const TriangleMesh& model, const Points& anchors);

/// One line, empty unless either side lies far from its own model and not from the other's: the models, or
/// "a" and "b", are exchanged. Throws as above.
std::string exchanged_sides(const Anchors& anchors, const TriangleMesh& source, const TriangleMesh& target);

/// "half of the anchors lie 12.3 or more from the model; they span 45, the model 4.5".
std::string to_string(const AnchorPlacement& placement);

}  // namespace bespoke
