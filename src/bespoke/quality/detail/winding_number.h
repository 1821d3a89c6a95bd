#pragma once

#include <memory>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// Generalised winding number of a surface around a point (Jacobson, Kavan, Sorkine-Hornung 2013): the solid
/// angle of all its triangles, divided by 4π. 1 inside of a closed surface whose faces look outwards, 0
/// outside, 2 inside of two nested ones, in between for open surfaces. Groups of faces that are far from the
/// point count by their dipole and its first derivative (Barill et al. 2018, Eq. 14), the others exactly; the
/// error stays below 0.02. Copies what it needs; queries are thread-safe.
class WindingNumber {
 public:
  /// Throws InvalidInput for a mesh that is not valid.
  explicit WindingNumber(const TriangleMesh& mesh);
  ~WindingNumber();
  WindingNumber(WindingNumber&&) noexcept;
  WindingNumber& operator=(WindingNumber&&) noexcept;

  /// At a finite point, mesh units.
  double operator()(const Vector3& x) const;
  /// Of a closed surface, whose number is whole: rounded from a sum with an error below 0.1, in less time.
  int whole(const Vector3& x) const;
  /// Whether it exceeds 1/2, from a sum with a larger error where that decides.
  bool exceeds_half(const Vector3& x) const;

 private:
  double number(const Vector3& x, double radii) const;

  struct Tree;
  std::unique_ptr<const Tree> tree_;
};

}  // namespace bespoke
