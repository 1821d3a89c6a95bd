#include "bespoke/registration/anchor_suggestions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <string>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/median.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/spread_points.h"
#include "bespoke/registration/detail/two_way_points.h"
#include "bespoke/registration/registration.h"

namespace bespoke {
namespace {

/// Places to choose from, about 1 to 2 % of the diagonal apart on a body.
constexpr std::size_t candidates = 1000;
/// A place counts as uncertain as the median of so many places around it: single vertices slide off edges.
constexpr std::size_t neighbours = 7;
/// Of the diagonal: within about so much of a pair, another one says little. Half of the distance that
/// maps reach by default, so that thirty pairs or so cover a body.
constexpr double suggestion_reach = 0.05;
/// Of the diagonal: no pair is taken for more accurate, as for those that people pick.
constexpr double min_sigma = 1e-3;

/// Of every candidate.
struct Uncertainty {
  std::vector<int> vertices;
  Points places;               ///< proposed on the target, target frame
  Eigen::VectorXd around;      ///< mesh units
  std::vector<double> sigmas;  ///< mesh units
};

Anchors turned_round(Anchors anchors) {
  for (AnchorPair& pair : anchors.pairs) std::swap(pair.a, pair.b);
  for (AnchorCurve& curve : anchors.curves) {
    std::swap(curve.a, curve.b);
    for (auto& [a, b] : curve.fixed) std::swap(a, b);
  }
  for (AnchorPatch& patch : anchors.patches) std::swap(patch.a, patch.b);
  return anchors;
}

/// For every column of `x` the median of `values` over the columns nearest to it.
Eigen::VectorXd medians_around(const Points& x, const Eigen::VectorXd& values) {
  const auto count = static_cast<std::size_t>(x.cols());
  const std::size_t most = std::min(neighbours, count);
  Eigen::VectorXd result(x.cols());
  std::vector<int> order(count);
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const Eigen::VectorXd squared = (x.colwise() - x.col(i)).colwise().squaredNorm();
    std::iota(order.begin(), order.end(), 0);
    std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(most), order.end(),
                      [&](int a, int b) { return std::pair(squared[a], a) < std::pair(squared[b], b); });
    std::vector<double> nearest;
    for (std::size_t k = 0; k < most; ++k) nearest.push_back(values[order[k]]);
    result[i] = median(std::move(nearest));
  }
  return result;
}

Uncertainty find_uncertainty(const TriangleMesh& source, const TriangleMesh& target,
                             const Registration& there, const Registration& back) {
  Uncertainty found;
  found.vertices = spread_vertices(source, candidates);
  const Points registered = registered_vertices(there);
  const TwoWayPoints points =
      two_way_points(source, registered, target, registered_vertices(back), found.vertices);
  const ClosestPointTree surface(target);
  const double least = min_sigma * diagonal(target.vertices);
  Eigen::VectorXd errors(points.apart.size());
  found.places.resize(3, points.apart.size());
  for (Eigen::Index k = 0; k < points.apart.size(); ++k) {
    const Vector3 place = registered.col(found.vertices[static_cast<std::size_t>(k)]);
    errors[k] = std::hypot(points.apart[k], std::sqrt(surface.closest(place)->squared_distance));
    found.places.col(k) = surface.closest(points.middles.col(k))->point;
    // Two guesses of variance σ² a coordinate differ by 6 σ² in the mean square.
    found.sigmas.push_back(std::max(points.apart[k] / std::sqrt(6.0), least));
  }
  found.around = medians_around(source.vertices(Eigen::all, found.vertices), errors);
  return found;
}

/// "suggested_1" and so on, past the names that are taken.
class Names {
 public:
  explicit Names(const Anchors& anchors) {
    for (const AnchorPair& pair : anchors.pairs) taken_.insert(pair.name);
  }
  std::string next() {
    std::string name;
    do name = "suggested_" + std::to_string(++last_);
    while (taken_.contains(name));
    return name;
  }

 private:
  std::set<std::string> taken_;
  int last_ = 0;
};

}  // namespace

std::vector<SuggestedAnchor> suggest_anchors(const TriangleMesh& source, const TriangleMesh& target,
                                             const Anchors& anchors, const SuggestionOptions& options,
                                             const Progress& progress) {
  if (!(options.tolerance > 0 && std::isfinite(options.tolerance)))
    throw InvalidInput("a tolerance of " + std::to_string(options.tolerance) + "; it must be above 0");
  FitOptions fitting;
  fitting.lambda = diagonal(source.vertices);
  fitting.any_size = true;  // the fit says what size the models may have
  const Anchors turned = turned_round(anchors);
  const Registration there = fit_source_surface({source, target, anchors}, fitting, progress);
  const Registration back = fit_source_surface({target, source, turned}, fitting, progress);
  const Uncertainty found = find_uncertainty(source, target, there, back);

  const Points x = source.vertices(Eigen::all, found.vertices);
  const double length = suggestion_reach * diagonal(source.vertices);
  Eigen::VectorXd worth = found.around;
  if (there.summary.surface) {
    // What patches exclude has no counterpart that could be proposed.
    const std::vector<int>& excluded = there.summary.surface->excluded_vertices;
    for (Eigen::Index k = 0; k < worth.size(); ++k)
      if (std::binary_search(excluded.begin(), excluded.end(), found.vertices[static_cast<std::size_t>(k)]))
        worth[k] = 0;
  }
  Names names(anchors);
  std::vector<SuggestedAnchor> suggestions;
  while (suggestions.size() < options.count) {
    Eigen::Index best = 0;
    if (worth.size() == 0 || worth.maxCoeff(&best) < options.tolerance) break;
    const auto candidate = static_cast<std::size_t>(best);
    const int vertex = found.vertices[candidate];
    suggestions.push_back({{names.next(), x.col(best), found.places.col(best),
                            std::numeric_limits<double>::infinity(), found.sigmas[candidate]},
                           found.around[best],
                           there.confidence[static_cast<std::size_t>(vertex)]});
    const Eigen::ArrayXd squared = (x.colwise() - x.col(best)).colwise().squaredNorm().transpose();
    worth.array() *= 1 - (-squared / (2 * length * length)).exp();
  }
  return suggestions;
}

}  // namespace bespoke
