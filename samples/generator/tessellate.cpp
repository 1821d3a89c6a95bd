#include "tessellate.h"

#include "isosurface.h"

namespace bespoke {

TriangleMesh tessellate(const Anatomy& shape, const std::optional<Field>& cut, const Tessellation& how) {
  TriangleMesh mesh =
      isosurface(shape.field, shape.inside, {shape.box, how.lattice_spacing, how.lattice_rotation});
  if (cut) mesh = clip(mesh, *cut);
  return remesh(mesh, shape.field, cut, how.edges);
}

Matrix3 oblique_rotation(double degrees) {
  const double radians = degrees * 3.14159265358979323846 / 180;
  return Eigen::AngleAxisd(radians, Vector3(0.48, 0.6, 0.64)).toRotationMatrix();
}

}  // namespace bespoke
