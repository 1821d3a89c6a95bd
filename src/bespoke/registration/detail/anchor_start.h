#pragma once

#include <string>

#include "bespoke/anchors/anchors.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/rigid/regularised_alignment.h"
#include "bespoke/rigid/rigid_transform.h"

namespace bespoke {

/// Mean distance between a source placed by a similarity and its target, from either to the other, at some
/// hundred vertices of each, mesh units of the target.
class SimilarityDistance {
 public:
  /// Copies what it needs. Throws InvalidInput for unusable meshes.
  SimilarityDistance(const TriangleMesh& source, const TriangleMesh& target);

  double operator()(const Similarity& target_from_source) const;
  /// Of a source whose points were moved by an isometry, its own inverse, before the similarity.
  double after(const Similarity& target_from_source, const RegularisedAlignment& reflection) const;

 private:
  ClosestPointTree source_surface_, target_surface_;
  Points source_places_, target_places_;
};

/// How the anchors alone bring the source to the target (IV.A, IV.B), where their spread says enough, and
/// with the surfaces' help where it does not.
struct AnchorStart {
  RegularisedAlignment alignment;
  RigidTransform target_from_source;  ///< Γ
  bool turned_by_surfaces = false;    ///< about the anchors' line, along which alone they spread
  /// Their spread exceeds the misfit, or is that of the source: then nothing is extrapolated, however a pose
  /// bends.
  bool determines_affine_map = false;
};

/// weights: as spline_weights, one a pair. Near a line anchors do not determine the turn about it: of 36
/// turns the one that brings the surfaces nearest is taken, where it does so clearly better than the anchors'
/// own. Throws InvalidInput where one model is a mirror image of the other, with the anchors that say so, and
/// as align_rigidly.
AnchorStart start_by_anchors(const Anchors& anchors, const Eigen::VectorXd& weights,
                             const TriangleMesh& source, const TriangleMesh& target);

}  // namespace bespoke
