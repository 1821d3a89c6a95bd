#include "bespoke/surface_fit/matching/cavities.h"

#include "bespoke/mesh/visibility.h"
#include "bespoke/parallel.h"
#include "bespoke/surface_fit/matching/reciprocity.h"

namespace bespoke {

std::vector<char> vertices_in_unmatched_cavities(const TargetSurface& source, const TargetSurface& target,
                                                 const CavitySettings& settings) {
  const MatchLimits limits{settings.min_cosine, settings.reach};
  const VisibilityQuery source_visibility(source.mesh()), target_visibility(target.mesh());
  const auto faces = [&](const VisibilityQuery& visibility, const Vector3& x, const Vector3& normal) {
    return visibility.is_blocked(x, normal, FaceSides::front, limits.max_distance);
  };
  const Points& vertices = source.mesh().vertices;
  std::vector<char> hidden(static_cast<std::size_t>(vertices.cols()), 0);
  constexpr std::size_t grain = 128;
  parallel_for(hidden.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Vector3 x = vertices.col(static_cast<Eigen::Index>(k));
      const Vector3 normal = source.normals().col(static_cast<Eigen::Index>(k));
      const auto counterpart = target.match(x, normal, limits);
      if (!counterpart || !faces(source_visibility, x, normal) ||
          faces(target_visibility, counterpart->point, counterpart->normal))
        continue;
      const auto nearer = back_match({x, *counterpart, limits}, source, settings.much_nearer);
      hidden[k] = nearer && !faces(source_visibility, nearer->point, nearer->normal);
    }
  });
  return hidden;
}

}  // namespace bespoke
