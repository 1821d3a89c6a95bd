#pragma once

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

}  // namespace bespoke
