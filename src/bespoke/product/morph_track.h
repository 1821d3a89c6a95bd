#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace bespoke {

/// How glTF goes through morph targets at t = 1/n, 2/n, …, 1 one after the other, in straight pieces.
struct MorphTrack {
  std::vector<std::string> names;  ///< of the targets: "t = 0.25"
  std::vector<float> times;        ///< n + 1 keys, seconds from 0
  std::vector<float> weights;      ///< n a key: at key k only target k has 1, at key 0 none
};

MorphTrack morph_track(std::size_t targets, double seconds);

}  // namespace bespoke
