#pragma once

#include <cstddef>
#include <string>

#include "bespoke/error.h"
#include "bespoke/statistics.h"

namespace bespoke {

/// How a part that keeps its shape may move.
enum class PartMotion {
  rigid,    ///< turned and shifted
  similar,  ///< and scaled
};

/// A part of a product that keeps its shape: a lens, a button, a sole. It moves by the motion of least
/// squares of its points as the map takes them, one for every frame.
struct RigidPart {
  /// An OBJ file's group, object or material, a glTF node with all that is below it, or a connected component
  /// of a PLY file: "1", "2", … in the order of their first vertices.
  std::string name;
  PartMotion motion = PartMotion::rigid;
};

/// A file has no part of that name.
class UnknownPart : public InvalidInput {
  using InvalidInput::InvalidInput;
};

struct PartSummary {
  std::string name;
  PartMotion motion = PartMotion::rigid;
  std::size_t points = 0;
  double scale = 1;      ///< of the motion in the last frame
  Statistics distances;  ///< of the part's points from where the map takes them in the last frame, mesh units
};

/// "lens: 120 points kept their shape, from where the map takes them: min 0 …", and its scale if it has one.
std::string to_string(const PartSummary& summary);

}  // namespace bespoke
