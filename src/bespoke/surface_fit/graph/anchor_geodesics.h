#pragma once

#include <vector>

#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/surface_fit/deformation_graph_settings.h"
#include "bespoke/surface_fit/graph/anchor_posterior.h"

namespace bespoke {

/// Places of the source and the vertices of the target that lie alike among the anchors.
struct GeodesicPairs {
  Points sources;  ///< 3×m, vertices of the source, diagonals
  Points targets;  ///< 3×m, on the target
};

/// Places by their distances along both surfaces from the anchors, which change little with the pose. A place
/// x is described by
///   λ(x) = l / |l|,  lₖ = √pₖ / (dₖ(x) + ε),
/// d_k its geodesic distance from anchor k and p_k the probability that this anchor is right: inverse
/// distance weights, which name a place between control points of a surface (Panozzo et al. 2013) whatever
/// the size of the part between them. Its counterpart is the vertex of the target with the nearest λ. Same
/// bytes at any thread count.
class AnchorGeodesics {
 public:
  /// anchors: 3×k, of which at most `max_anchors` are measured from. They need not lie on the surfaces.
  /// Throws InvalidInput for meshes without faces.
  AnchorGeodesics(const TriangleMesh& source, const TriangleMesh& target, const Points& anchor_sources,
                  const Points& anchor_targets, const GeodesicSettings& settings);

  /// inliers: k, as AnchorPosterior has them. Left out are places whose counterpart's own counterpart is
  /// farther off than `max_return`, and those for which a place elsewhere on the target would do nearly as
  /// well. None for fewer than `min_anchors`.
  GeodesicPairs pairs(const std::vector<double>& inliers) const;

  /// How far each anchor's target is from where the others put its source; how freely the source lies there:
  /// 1 / |l|² of the others.
  LeftOutAnchors left_out(const std::vector<double>& inliers) const;

 private:
  /// A surface whose vertices are described, s of them, m the anchors that are measured from.
  struct Surface {
    Points places;               // 3×s
    Eigen::MatrixXd described;   // m×s, inverse distances
    Eigen::MatrixXd at_anchors;  // m×k: of the anchors' places

    Surface(const TriangleMesh& mesh, const Points& anchors, const std::vector<int>& from,
            const GeodesicSettings& settings);
  };

  Eigen::VectorXd weights(const std::vector<double>& inliers) const;

  GeodesicSettings settings_;
  Points anchor_targets_;
  std::vector<int> from_;  // columns of the anchors that are measured from
  Surface source_, target_;
};

}  // namespace bespoke
