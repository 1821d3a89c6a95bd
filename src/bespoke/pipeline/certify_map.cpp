#include "bespoke/pipeline/certify_map.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "bespoke/error.h"

namespace bespoke {

Certificate certify_map(const Asset& asset, double t, const Progress& progress) {
  const auto count = static_cast<double>(asset.steps.size());
  if (asset.steps.size() > 1 && asset.path != RotationPath::flow && t != 0 && t != 1)
    throw InvalidInput("a chain of " + std::to_string(asset.steps.size()) +
                       " steps can be certified at t = " + std::to_string(t) +
                       " on its flow only, and this map's path is another");
  Asset proved;
  proved.steps.clear();
  for (std::size_t k = 0; k < asset.steps.size(); ++k) {
    // Step k takes place from k / count to (k + 1) / count; the first and the last one go on beyond [0, 1].
    double fraction = t * count - static_cast<double>(k);
    if (k > 0) fraction = std::max(fraction, 0.0);
    if (k + 1 < asset.steps.size()) fraction = std::min(fraction, 1.0);
    if (k > 0 && fraction == 0) break;
    const MapStep& step = asset.steps[k];
    proved.steps.push_back({step.affine, {}, certify(step.pyramid, step.affine, fraction, progress)});
  }
  return whole_certificate(proved);
}

}  // namespace bespoke
