#include "bespoke/anchors/anchor_scale.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/number_format.h"
#include "bespoke/statistics.h"

namespace bespoke {
namespace {

// Fewer come near a surface by chance, with one factor to choose.
constexpr Eigen::Index fewest_anchors = 4;
constexpr Eigen::Index max_anchors = 60;  // tell as much as more
// Nearer than this, relative to what they span, anchors are on their model, or inside it as joints are.
constexpr double plausible_distance = 0.05;
constexpr double improvement = 5;
// Below this a factor is a size, or the corners of a box around the model; no two units in use are closer.
constexpr double min_factor = 2;
constexpr double largest_factor = 2000;  // metres to millimetres, and somewhat more
constexpr double grid_step = 1.03;       // finer than the distances that are told apart

/// Three quarters of the anchors are no farther from the model than this, relative to the smaller span.
double relative_distance(std::vector<double> distances, double anchor_span, double model_span) {
  return nearest_rank(sorted_finite(std::move(distances)), 0.75) / std::min(anchor_span, model_span);
}

class ScaledAnchors {
 public:
  ScaledAnchors(const TriangleMesh& model, const Points& anchors)
      : tree_(model), anchors_(anchors), span_(diagonal(anchors)), model_span_(diagonal(model.vertices)) {}

  double distance(double factor) const {
    std::vector<double> distances;
    for (const auto& anchor : anchors_.colwise())
      distances.push_back(std::sqrt(tree_.closest(Vector3(factor * anchor))->squared_distance));
    return relative_distance(std::move(distances), factor * span_, model_span_);
  }

  /// The factor of the least distance near a place of the grid.
  double refined(double factor) const {
    double begin = factor / grid_step, end = factor * grid_step;
    while (end / begin > 1.0001) {
      const double third = std::cbrt(end / begin), low = begin * third, high = end / third;
      (distance(low) < distance(high) ? end : begin) = distance(low) < distance(high) ? high : low;
    }
    return std::sqrt(begin * end);
  }

 private:
  ClosestPointTree tree_;
  Points anchors_;
  double span_, model_span_;
};

/// The ratio of two units in use that the factor is within its accuracy, else the factor. Anchors lie on a
/// smooth surface, not on the model's faces, so that the factor errs by their distance.
double as_unit_ratio(double factor) {
  for (const double ratio : {2.54, 10.0, 12.0, 25.4, 30.48, 39.37, 100.0, 304.8, 3.2808, 1000.0})
    for (const double candidate : {ratio, 1 / ratio})
      if (std::abs(std::log(factor / candidate)) < std::log(grid_step)) return candidate;
  return factor;
}

void require_at_scale(const TriangleMesh& model, const Points& anchors, const std::string& role,
                      const std::string& side) {
  const std::optional<double> measured = anchor_scale(model, anchors);
  if (!measured) return;
  const double factor = as_unit_ratio(*measured);
  throw InvalidInput("the anchors do not lie on the " + role + ", but would if their \"" + side +
                     "\" were multiplied by " + format_number(factor, 3) + ", or the " + role + " by " +
                     format_number(1 / factor, 3) +
                     ": bring both to one unit, or say that they are meant so (--any-anchors)");
}

}  // namespace

std::optional<double> anchor_scale(const TriangleMesh& model, const Points& anchors) {
  if (anchors.cols() < fewest_anchors || !(diagonal(anchors) > 0)) return std::nullopt;
  Points some = anchors;
  if (anchors.cols() > max_anchors) {
    some.resize(3, max_anchors);
    for (Eigen::Index i = 0; i < max_anchors; ++i)
      some.col(i) = anchors.col(i * anchors.cols() / max_anchors);
  }
  if (std::vector<double> most = distances_from_vertices(model, some);
      !most.empty() &&
      relative_distance(std::move(most), diagonal(some), diagonal(model.vertices)) <= plausible_distance)
    return std::nullopt;
  const ScaledAnchors scaled(model, some);
  const double now = scaled.distance(1);
  if (now <= plausible_distance) return std::nullopt;
  double best = 1, least = now;
  for (double factor = min_factor; factor < largest_factor; factor *= grid_step)
    for (const double candidate : {factor, 1 / factor})
      if (const double distance = scaled.distance(candidate); distance < least) {
        least = distance;
        best = candidate;
      }
  if (best == 1) return std::nullopt;
  best = scaled.refined(best);
  if (!(scaled.distance(best) * improvement < now)) return std::nullopt;
  return best;
}

void require_anchors_at_scale(const Anchors& anchors, const TriangleMesh& source,
                              const TriangleMesh& target) {
  require_at_scale(source, source_points(anchors), "source", "a");
  require_at_scale(target, target_points(anchors), "target", "b");
}

void scale_anchors(Anchors& anchors, double source_scale, double target_scale) {
  for (AnchorPair& pair : anchors.pairs) {
    pair.a *= source_scale;
    pair.b *= target_scale;
    if (pair.sigma) *pair.sigma *= target_scale;
  }
  for (AnchorCurve& curve : anchors.curves) {
    curve.a *= source_scale;
    curve.b *= target_scale;
  }
  for (AnchorPatch& patch : anchors.patches) {
    patch.a.border *= source_scale;
    patch.b.border *= target_scale;
  }
}

}  // namespace bespoke
