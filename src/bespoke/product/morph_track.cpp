#include "bespoke/product/morph_track.h"

#include <cstdio>

namespace bespoke {

MorphTrack morph_track(std::size_t targets, double seconds) {
  MorphTrack track;
  track.weights.resize((targets + 1) * targets);
  for (std::size_t k = 0; k <= targets; ++k) {
    const double t = static_cast<double>(k) / static_cast<double>(targets);
    track.times.push_back(static_cast<float>(seconds * t));
    if (k == 0) continue;
    track.weights[k * targets + k - 1] = 1;
    char name[32];
    std::snprintf(name, sizeof name, "t = %.4g", t);
    track.names.emplace_back(name);
  }
  return track;
}

}  // namespace bespoke
