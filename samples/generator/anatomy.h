#pragma once

#include <string>
#include <vector>

#include "bespoke/types.h"
#include "solid.h"

namespace bespoke {

/// A named point on a reference model's surface, cm.
struct Landmark {
  std::string name;
  Vector3 point;
};

/// A reference model before it is meshed. y points up, z to the front, x to the model's left; cm.
struct Anatomy {
  Field field;
  Vector3 inside;  ///< a point inside
  Box box;         ///< contains the surface
  std::vector<Landmark> landmarks;
};

}  // namespace bespoke
