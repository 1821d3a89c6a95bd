#include "bespoke/pipeline/disowned_anchors.h"

#include <algorithm>

namespace bespoke {

std::vector<LeftOutAnchor> disowned_anchors(std::vector<std::size_t> doubted, const DisownAnchors& disown) {
  while (!doubted.empty()) {
    std::vector<LeftOutAnchor> disowned = disown(doubted);
    if (disowned.size() == doubted.size()) return disowned;
    doubted.clear();
    for (const LeftOutAnchor& anchor : disowned) doubted.push_back(anchor.index);
  }
  return {};
}

std::vector<std::size_t> disowned_alone(const std::vector<LeftOutAnchor>& together,
                                        const DisownAnchors& disown) {
  std::vector<std::size_t> alone;
  for (const LeftOutAnchor& anchor : together)
    if (!disown({anchor.index}).empty()) alone.push_back(anchor.index);
  return alone;
}

std::vector<LeftOutAnchor> not_taken_back(const std::vector<LeftOutAnchor>& disowned,
                                          const TakeBackAnchor& take_back) {
  std::vector<LeftOutAnchor> nearest_first = disowned, left_out = disowned;
  std::stable_sort(nearest_first.begin(), nearest_first.end(),
                   [](const LeftOutAnchor& a, const LeftOutAnchor& b) { return a.distance < b.distance; });
  for (const LeftOutAnchor& anchor : nearest_first) {
    std::vector<std::size_t> others;
    for (const LeftOutAnchor& other : left_out)
      if (other.index != anchor.index) others.push_back(other.index);
    if (take_back(anchor.index, others))
      std::erase_if(left_out, [&](const LeftOutAnchor& other) { return other.index == anchor.index; });
  }
  return left_out;
}

}  // namespace bespoke
