#include "bespoke/registration/detail/align_by_anchors.h"

#include <Eigen/LU>
#include <limits>
#include <string>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/rbf/global_rbf.h"
#include "bespoke/registration/detail/anchor_start.h"
#include "bespoke/stopwatch.h"

namespace bespoke {
namespace {

PointPairs pairs_of(const Anchors& anchors) {
  return {source_points(anchors), target_points(anchors), spline_weights(anchors), sigmas(anchors)};
}

/// Exact pairs at the corners of a box around the source, a tenth larger, which an affine map moves.
PointPairs with_corners(PointPairs pairs, const TriangleMesh& source, const AffineMap& map) {
  constexpr double larger = 1.1, thickest_sheet = 0.1;  // the latter of the diagonal
  const Box box = bounding_box(source.vertices);
  const Vector3 sizes = larger * box.sizes().cwiseMax(thickest_sheet * box.diagonal().norm());
  const Eigen::Index count = pairs.sources.cols();
  Points corners(3, 8);
  for (int k = 0; k < 8; ++k)
    corners.col(k) =
        box.center() + sizes.cwiseProduct(Vector3(k & 4 ? 1 : -1, k & 2 ? 1 : -1, k & 1 ? 1 : -1)) / 2;
  pairs.sources.conservativeResize(3, count + 8);
  pairs.sources.rightCols(8) = corners;
  pairs.targets.conservativeResize(3, count + 8);
  pairs.targets.rightCols(8) = map * corners;
  pairs.weights.conservativeResize(count + 8);
  pairs.weights.tail(8).setConstant(std::numeric_limits<double>::infinity());
  return pairs;
}

struct CoarseWarp {
  Points warped;
  CoarseSummary summary;
};

/// The coarse warp of the source's vertices (IV.B). pairs: the anchors, source frame, the first `count` of
/// which were given. Where their spread does not determine the affine part, corners of a box tell it, as
/// the regularised alignment takes them.
CoarseWarp warp_coarsely(const TriangleMesh& source, PointPairs pairs, Eigen::Index count,
                         const AnchorStart& start) {
  const Stopwatch watch;
  CoarseSummary summary;
  const RegularisedAlignment& alignment = start.alignment;
  summary.regularised = pairs.sources.cols() > 3 && !start.determines_affine_map;
  summary.turned_by_surfaces = start.turned_by_surfaces;
  summary.anchor_widths = alignment.widths;
  if (summary.regularised) {
    const Matrix3 back = start.target_from_source.rotation.transpose();
    const AffineMap& map = alignment.affine.linear.determinant() > 0
                               ? alignment.affine
                               : AffineMap{alignment.similarity.scale * alignment.similarity.rotation,
                                           alignment.similarity.translation};
    pairs = with_corners(std::move(pairs), source,
                         {back * map.linear, back * (map.offset - start.target_from_source.translation)});
  }
  const GlobalRbf coarse(pairs.sources, pairs.targets, pairs.weights);
  Points warped = coarse(source.vertices);
  summary.residuals =
      summarize(distances(coarse(pairs.sources.leftCols(count)), pairs.targets.leftCols(count)));
  summary.seconds = watch.seconds();
  return {std::move(warped), std::move(summary)};
}

}  // namespace

AnchorAlignment align_by_anchors(const Problem& problem, const EstimatedAnchors& estimated,
                                 const std::vector<AnchorPair>& leading, const Progress& progress) {
  const auto count = static_cast<Eigen::Index>(estimated.anchors.pairs.size());
  Anchors all = estimated.anchors;
  all.pairs.insert(all.pairs.end(), leading.begin(), leading.end());
  AnchorAlignment result;
  result.pairs = pairs_of(all);
  PointPairs& pairs = result.pairs;

  // IV.A: Γ. From here on everything is in the source frame.
  const Stopwatch rigid_watch;
  progress.step("rigid", 0, 0);
  if (const std::string off = off_target(estimated.accuracy, problem.target); !off.empty())
    throw InvalidInput(off);
  const AnchorStart start =
      start_by_anchors(estimated.anchors, pairs.weights.head(count), problem.source, problem.target);
  result.target_from_source = start.target_from_source;
  result.rigid =
      rigid_summary(result.target_from_source, pairs.sources.leftCols(count), pairs.targets.leftCols(count));
  const RigidTransform source_from_target = inverse(result.target_from_source);
  pairs.targets = (source_from_target * pairs.targets).eval();
  result.target = {source_from_target * problem.target.vertices, problem.target.faces};
  result.rigid.seconds = rigid_watch.seconds();

  // IV.B: Ẽ.
  progress.step("coarse", 0, 0);
  CoarseWarp coarse = warp_coarsely(problem.source, pairs, count, start);
  result.warped = std::move(coarse.warped);
  result.coarse = std::move(coarse.summary);
  return result;
}

}  // namespace bespoke
