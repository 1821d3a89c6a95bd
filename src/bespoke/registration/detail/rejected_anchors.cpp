#include "bespoke/registration/detail/rejected_anchors.h"

#include <algorithm>

namespace bespoke {

std::vector<RejectedAnchor> rejected_anchors(std::vector<std::size_t> suspects, const RejectAnchors& reject) {
  while (!suspects.empty()) {
    std::vector<RejectedAnchor> rejected = reject(suspects);
    if (rejected.size() == suspects.size()) return rejected;
    suspects.clear();
    for (const RejectedAnchor& anchor : rejected) suspects.push_back(anchor.index);
  }
  return {};
}

std::vector<std::size_t> rejected_alone(const std::vector<RejectedAnchor>& together,
                                        const RejectAnchors& reject) {
  std::vector<std::size_t> alone;
  for (const RejectedAnchor& anchor : together)
    if (!reject({anchor.index}).empty()) alone.push_back(anchor.index);
  return alone;
}

std::vector<RejectedAnchor> not_reinstated(const std::vector<RejectedAnchor>& rejected,
                                           const ReinstateAnchor& reinstate) {
  std::vector<RejectedAnchor> nearest_first = rejected, left_out = rejected;
  std::stable_sort(nearest_first.begin(), nearest_first.end(),
                   [](const RejectedAnchor& a, const RejectedAnchor& b) { return a.distance < b.distance; });
  for (const RejectedAnchor& anchor : nearest_first) {
    std::vector<std::size_t> others;
    for (const RejectedAnchor& other : left_out)
      if (other.index != anchor.index) others.push_back(other.index);
    if (reinstate(anchor.index, others))
      std::erase_if(left_out, [&](const RejectedAnchor& other) { return other.index == anchor.index; });
  }
  return left_out;
}

}  // namespace bespoke
