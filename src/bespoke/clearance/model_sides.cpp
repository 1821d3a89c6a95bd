#include "bespoke/clearance/model_sides.h"

#include <utility>

#include "bespoke/asset/model_distances.h"
#include "bespoke/quality/signed_distance.h"

namespace bespoke {

Asset with_model_sides(Asset asset, const TriangleMesh& source, const TriangleMesh& target) {
  const SignedDistance from_source(source), from_target(target);
  return with_model_distances(std::move(asset),
                              {source, [&](const Points& x) { return std::move(from_source(x).distance); }},
                              {target, [&](const Points& x) { return std::move(from_target(x).distance); }});
}

}  // namespace bespoke
