#pragma once

#include "bespoke/types.h"

namespace bespoke {

/// Conjugate gradients (Hestenes, Stiefel 1952) for the three rows of a right-hand side at once: A x = b with
/// A n×n, symmetric positive definite, x and b 3×n. `solution` holds the start and becomes the result;
/// `residual` is that of the start. Solved rows stay. Returns the number of steps. `System`, const:
/// multiply(x): A x; precondition(residual): M⁻¹ r; products(a, b): one scalar product a row;
/// solved(residual, products, steps): products of r and M⁻¹ r, may throw.
template <class System>
int conjugate_gradients(const System& system, Points& solution, Points residual) {
  const auto ratio = [](const Vector3& a, const Vector3& b) -> Vector3 {
    return (b.array() > 0).select(a.array() / b.array(), 0).matrix();
  };
  Points direction = system.precondition(residual);
  Vector3 product = system.products(residual, direction);
  int steps = 0;
  for (; !system.solved(residual, product, steps); ++steps) {
    const Points image = system.multiply(direction);
    const Vector3 length = ratio(product, system.products(direction, image));
    solution += length.asDiagonal() * direction;
    residual -= length.asDiagonal() * image;
    const Points preconditioned = system.precondition(residual);
    const Vector3 next = system.products(residual, preconditioned);
    direction = preconditioned + ratio(next, product).asDiagonal() * direction;
    product = next;
  }
  return steps;
}

}  // namespace bespoke
