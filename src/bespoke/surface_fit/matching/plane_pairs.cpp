#include "bespoke/surface_fit/matching/plane_pairs.h"

#include <algorithm>

#include "bespoke/parallel.h"
#include "bespoke/surface_fit/matching/crease.h"
#include "bespoke/surface_fit/matching/reciprocity.h"

namespace bespoke {
namespace {

/// One direction of correspondence: whose vertices search, and on which surface.
struct Search {
  const PairSurfaces& surfaces;
  const NodeLevel& level;
  const NodeFitSettings& settings;
  bool from_source;  ///< else from the target

  const TargetSurface& from() const { return from_source ? surfaces.source : surfaces.target; }
  const TargetSurface& onto() const { return from_source ? surfaces.target : surfaces.source; }
  const Eigen::VectorXd& areas() const { return from_source ? surfaces.source_areas : surfaces.target_areas; }
  std::size_t samples() const { return from_source ? level.samples : level.back_samples; }
  double share() const { return from_source ? 1 : settings.back_share; }
  MatchLimits limits(Eigen::Index vertex) const {
    return {.min_cosine = settings.min_cosine,
            .max_distance = settings.max_distance,
            .normal_length = settings.normal_length,
            .patch = from().patch(vertex)};
  }
};

/// Where anchors tell the pose and the source still lies outside the target, it is its shape that differs,
/// or a joint that has bent at another place.
double outside(const Search& search, const FoundPair& pair, int source_vertex) {
  const Eigen::VectorXd* certainty = search.surfaces.pose_certainty;
  if (!certainty) return 0;
  const double step = (pair.match.point - pair.point).dot(pair.match.halfway);
  const bool is_outside = search.from_source ? step < 0 : step > 0;
  return is_outside ? (*certainty)[source_vertex] : 0;
}

/// Ratio of back distance to distance (reciprocity.h) as far as the pair depends on it; 1 beyond.
double back_ratio(const Search& search, const FoundPair& pair, double off) {
  const ReciprocitySettings& settings = search.settings.reciprocity;
  if (may_be_creased(pair)) return back_distance_ratio(pair, search.from(), 1, settings);
  if (!search.level.reciprocity && off == 0) return 1;
  return back_distance_ratio(pair, search.from(), settings.much_nearer, settings);
}

/// Which vertex of the source shall go where, as a vertex of the searching surface found.
PlanePair pair_of(const Search& search, Eigen::Index vertex, const SurfaceMatch& match) {
  PlanePair pair{.vertex = static_cast<int>(vertex), .point = match.point, .normal = match.halfway};
  if (search.from_source) return pair;
  const TriangleMesh& source = search.surfaces.source.mesh();
  int corner = 0;
  match.barycentric.maxCoeff(&corner);
  pair.vertex = source.faces(corner, match.face);
  pair.point = search.from().mesh().vertices.col(vertex) + source.vertices.col(pair.vertex) - match.point;
  return pair;
}

/// Appends the pairs of every so many vertices.
void append_pairs(const Search& search, std::vector<PlanePair>& pairs) {
  const Points& points = search.from().mesh().vertices;
  const ReciprocitySettings& settings = search.settings.reciprocity;
  const std::size_t count = static_cast<std::size_t>(points.cols());
  const std::size_t stride = (count + search.samples() - 1) / search.samples();
  std::vector<PlanePair> found((count + stride - 1) / stride);
  constexpr std::size_t grain = 128;
  parallel_for(found.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto i = static_cast<Eigen::Index>(k * stride);
      const MatchLimits limits = search.limits(i);
      const auto match = search.onto().match(points.col(i), search.from().normals().col(i), limits);
      if (!match) continue;
      found[k] = pair_of(search, i, *match);
      const FoundPair pair{points.col(i), *match, limits};
      const double off = outside(search, pair, found[k].vertex);
      const double back = back_ratio(search, pair, off);
      const double fading = reciprocity(back, settings);
      found[k].outlier_scale_gain = fading * std::max(crease(pair, back), off);
      found[k].weight = search.share() * search.areas()[i] * double(stride) * match->agreement *
                        match->agreement * (search.level.reciprocity ? fading : 1);
    }
  });
  for (const PlanePair& pair : found)
    if (pair.weight > 0 && search.surfaces.source_areas[pair.vertex] > 0) pairs.push_back(pair);
}

}  // namespace

std::vector<PlanePair> find_plane_pairs(const PairSurfaces& surfaces, const NodeLevel& level,
                                        const NodeFitSettings& settings) {
  std::vector<PlanePair> pairs;
  for (const bool from_source : {true, false}) append_pairs({surfaces, level, settings, from_source}, pairs);
  return pairs;
}

}  // namespace bespoke
