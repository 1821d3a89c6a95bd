#include "bespoke/report/chain_determinant.h"

#include <vector>

#include "bespoke/quality/sampled_determinant.h"

namespace bespoke {

double sampled_min_determinant(const Asset& asset) {
  std::vector<const Pyramid*> pyramids;
  for (const MapStep& step : asset.steps) pyramids.push_back(&step.pyramid);
  return sampled_min_determinant(baked_chain(asset.steps), pyramids);
}

}  // namespace bespoke
