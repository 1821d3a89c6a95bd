#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "bespoke/product/point_motion.h"
#include "bespoke/progress.h"

namespace bespoke {

struct MorphSummary {
  std::size_t points = 0;             ///< positions that got targets
  double off_path = 0;                ///< how far they are off at most half way between targets, scene units
  std::vector<std::string> warnings;  ///< what the file holds that was left as it is, a sentence each
};

/// Writes a .glb anew, with morph targets of what nodes show, and an animation through them; all else stays
/// as it was: materials, texture coordinates, skins, and every number of the meshes themselves, which are at
/// t = 0. The motion has 2n frames, at t = 1/2n, 2/2n, …, 1: every second one is a target, the others tell
/// how far straight pieces are off. Throws as carry_product; InvalidInput for a name that does not end in
/// .glb, a buffer that is not in the file, and meshes that have morph targets already.
MorphSummary morph_product(const std::filesystem::path& input, const std::filesystem::path& output,
                           const PointMotion& motion, double seconds, const Progress& progress = {});

/// How glTF goes through morph targets at t = 1/n, 2/n, …, 1 one after the other, in straight pieces.
struct MorphTrack {
  std::vector<std::string> names;  ///< of the targets: "t = 0.25"
  std::vector<float> times;        ///< n + 1 keys, seconds from 0
  std::vector<float> weights;      ///< n a key: at key k only target k has 1, at key 0 none
};

MorphTrack morph_track(std::size_t targets, double seconds);

}  // namespace bespoke
