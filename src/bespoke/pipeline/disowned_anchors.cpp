#include "bespoke/pipeline/disowned_anchors.h"

#include <utility>

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

}  // namespace bespoke
