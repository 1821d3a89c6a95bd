#pragma once

#include <cmath>

#include "support/shapes.h"

namespace bespoke::shapes {

/// A sphere with bumps that no rotation maps onto itself.
inline TriangleMesh potato(int levels) {
  TriangleMesh mesh = icosphere(levels);
  for (auto&& x : mesh.vertices.colwise())
    x *= 1 + 0.2 * x[0] * x[1] + 0.15 * x[2] * x[2] * x[2] + 0.1 * std::sin(3 * x[0]);
  return mesh;
}

/// Space around it, bent.
inline Vector3 bend(const Vector3& x) {
  return {x[0] + 0.15 * x[1] * x[1], 1.1 * x[1] + 0.1 * x[0] * x[2], 0.95 * x[2]};
}

}  // namespace bespoke::shapes
