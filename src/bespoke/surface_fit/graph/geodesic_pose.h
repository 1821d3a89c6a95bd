#pragma once

#include <vector>

#include "bespoke/anchors/patch_faces.h"
#include "bespoke/surface_fit/graph/anchor_geodesics.h"
#include "bespoke/surface_fit/graph/anchor_pose.h"
#include "bespoke/surface_fit/graph/anchor_posterior.h"

namespace bespoke {

/// What a source is posed by. Lengths in diagonals.
struct GeodesicPoseInput {
  const TriangleMesh& rest;         ///< aligned with the target by one similarity
  const FacePatches& patches;       ///< of its faces: excluded ones have no places
  const TriangleMesh& target;       ///< without what is excluded
  const Points& anchor_sources;     ///< 3×k, aligned like `rest`; need not lie on it
  const Points& anchor_targets;     ///< 3×k
  const Eigen::VectorXd& sigmas;    ///< k, ≥ 0: accuracies that the pose takes the anchors for
  Eigen::VectorXd given_sigmas;     ///< k, ≥ 0: their own, by which outliers are told
  const std::vector<char>& tested;  ///< k: whether an anchor may be an outlier; empty: none may
};

/// A source in a pose (PosingByAnchors), by its anchors and the pairs between them, without the outliers that
/// distances along the surfaces tell (AnchorGeodesics, AnchorPosterior).
class GeodesicPose {
 public:
  /// What `input` refers to, and `settings`, must outlive it. Throws InvalidInput for meshes without faces.
  GeodesicPose(const GeodesicPoseInput& input, const PoseSettings& settings);

  /// Whether enough anchors are tested for the others to tell.
  bool has_tested() const { return posterior_.is_active(); }
  /// Of the anchors, ascending.
  std::vector<Eigen::Index> outliers() const { return posterior_.outliers(); }
  /// PosingByAnchors::rotation_spread, degrees, by the anchors alone. Throws SolverError.
  double turn_degrees() const;
  /// Outliers are carried along. Throws SolverError.
  AnchorPose bent() const;

 private:
  std::vector<double> inliers() const;
  void tell_outliers();

  GeodesicPoseInput input_;
  const PoseSettings& settings_;
  AnchorGeodesics geodesics_;
  AnchorPosterior posterior_;
  Eigen::VectorXd sigmas_;
};

}  // namespace bespoke
