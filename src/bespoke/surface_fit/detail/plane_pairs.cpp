#include "bespoke/surface_fit/detail/plane_pairs.h"

#include <algorithm>

#include "bespoke/parallel.h"
#include "bespoke/surface_fit/detail/crease.h"
#include "bespoke/surface_fit/detail/reciprocity.h"

namespace bespoke {
namespace {

/// The surface whose vertices ask, with what they speak for, and the one that answers.
struct Search {
  bool source_asks;
  const TargetSurface& asking;
  const TargetSurface& answering;
  const Eigen::VectorXd& areas;
  const Eigen::VectorXd& source_areas;
  MatchLimits limits;
  const ReciprocitySettings& reciprocity;
  bool fade;  // whether weights heed it
  std::size_t samples;
  double share;
  const Eigen::VectorXd* pose_certainty;
};

/// Where anchors tell the pose and the source still stands out of the target, it is its shape that differs,
/// or a joint that has bent at another place.
double sinking(const Search& search, const FoundPair& pair, int source_vertex) {
  if (!search.pose_certainty) return 0;
  const double step = (pair.match.point - pair.point).dot(pair.match.halfway);
  const bool stands_out = search.source_asks ? step < 0 : step > 0;
  return stands_out ? (*search.pose_certainty)[source_vertex] : 0;
}

/// Appends the pairs of every so many vertices; make_pair(i, match) says which vertex shall go where.
template <class MakePair>
void append_pairs(const Search& search, const MakePair& make_pair, std::vector<PlanePair>& pairs) {
  const Points& points = search.asking.mesh().vertices;
  const std::size_t count = static_cast<std::size_t>(points.cols());
  const std::size_t stride = (count + search.samples - 1) / search.samples;
  std::vector<PlanePair> found((count + stride - 1) / stride);
  constexpr std::size_t grain = 128;
  parallel_for(found.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto i = static_cast<Eigen::Index>(k * stride);
      MatchLimits limits = search.limits;
      limits.patch = search.asking.patch(i);
      const auto match = search.answering.match(points.col(i), search.asking.normals().col(i), limits);
      if (!match) continue;
      found[k] = make_pair(i, *match);
      found[k].normal = match->halfway;
      const FoundPair pair{points.col(i), *match, limits};
      const double claimed = claimed_share(pair, search.asking, 1, search.reciprocity);
      const double fading = reciprocity(claimed, search.reciprocity);
      found[k].leeway = fading * std::max(crease(pair, claimed), sinking(search, pair, found[k].vertex));
      found[k].weight = search.share * search.areas[i] * double(stride) * match->agreement *
                        match->agreement * (search.fade ? fading : 1);
    }
  });
  for (const PlanePair& pair : found)
    if (pair.weight > 0 && search.source_areas[pair.vertex] > 0) pairs.push_back(pair);
}

}  // namespace

std::vector<PlanePair> find_plane_pairs(const PairSurfaces& surfaces, const NodeLevel& level,
                                        const NodeFitSettings& settings) {
  const MatchLimits limits{settings.min_cosine, settings.max_distance * surfaces.diagonal,
                           settings.normal_length * surfaces.diagonal};
  std::vector<PlanePair> pairs;
  append_pairs(
      {.source_asks = true,
       .asking = surfaces.source,
       .answering = surfaces.target,
       .areas = surfaces.source_areas,
       .source_areas = surfaces.source_areas,
       .limits = limits,
       .reciprocity = settings.reciprocity,
       .fade = level.reciprocity,
       .samples = level.samples,
       .share = 1,
       .pose_certainty = surfaces.pose_certainty},
      [](Eigen::Index vertex, const SurfaceMatch& match) {
        return PlanePair{static_cast<int>(vertex), match.point, Vector3::Zero(), 0};
      },
      pairs);
  const TriangleMesh& source = surfaces.source.mesh();
  append_pairs(
      {.source_asks = false,
       .asking = surfaces.target,
       .answering = surfaces.source,
       .areas = surfaces.target_areas,
       .source_areas = surfaces.source_areas,
       .limits = limits,
       .reciprocity = settings.reciprocity,
       .fade = level.reciprocity,
       .samples = level.back_samples,
       .share = settings.back_share,
       .pose_certainty = surfaces.pose_certainty},
      [&](Eigen::Index i, const SurfaceMatch& match) {
        int corner = 0;
        match.barycentric.maxCoeff(&corner);
        const int vertex = source.faces(corner, match.face);
        return PlanePair{vertex,
                         surfaces.target.mesh().vertices.col(i) + source.vertices.col(vertex) - match.point,
                         Vector3::Zero(), 0};
      },
      pairs);
  return pairs;
}

}  // namespace bespoke
