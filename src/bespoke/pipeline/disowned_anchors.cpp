#include "bespoke/pipeline/disowned_anchors.h"

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

}  // namespace bespoke
