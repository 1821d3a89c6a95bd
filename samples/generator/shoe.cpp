#include <algorithm>
#include <cmath>

#include "accessories.h"
#include "tessellate.h"

namespace bespoke {
namespace {

constexpr double sole_top = -0.2;      // cm, from the underside of the foot
constexpr double upright_below = 0.9;  // cm
constexpr double sole_bottom = -0.65;  // at the ball, where the shoe touches the floor

// The foot with the lift of its heel undone.
Vector3 flattened(const FootBuild& build, const Vector3& p) {
  return {p.x(), p.y() - heel_lift(build, p.z()), p.z()};
}

// Closed, without toes, its walls upright near the sole; in flattened coordinates.
Field last(const FootBuild& build, const Anatomy& foot) {
  const double w = build.width;
  const double l = build.length;
  Solid toe_box;
  toe_box.add(Loft({{7 * l, 0.2, 1.6, 4.2 * w, 2.6 * build.instep, 1.6},
                    {10.5 * l, 0.05, 1.5, 4.95 * w, 2.5, 1.5},
                    {13 * l, -0.1, 1.4, 4.9 * w, 2.05, 1.5},
                    {15.5 * l, -0.5, 1.3, 4.2 * w, 1.65, 1.4},
                    {17.4 * l, -1.0, 1.2, 2.9 * w, 1.3, 1.3},
                    {18.0 * l, -1.15, 1.1, 2.2 * w, 1.1, 1.2}},
                   1.0, 1.5, 2.1),
              0.0);
  Solid lying_toe_box;
  lying_toe_box.add(toe_box, lying(), 0.0);
  return [build, lying_toe_box, inner = foot.field](const Vector3& flat) {
    const Vector3 raised(flat.x(), smooth_max(flat.y(), upright_below, 0.6), flat.z());
    const Vector3 p(raised.x(), raised.y() + heel_lift(build, raised.z()), raised.z());
    return smooth_min(inner(p) - 0.28, lying_toe_box(raised), 2.0);
  };
}

Box roomy(const Anatomy& foot) {
  Box box = foot.box;
  box.extend(Vector3(-9, -3, -10));
  box.extend(Vector3(9, 24, 24));
  return box;
}

}  // namespace

TriangleMesh shoe_upper(const FootBuild& build, const Anatomy& foot) {
  const Field shape = last(build, foot);
  const double l = build.length;
  Anatomy upper;
  upper.field = [build, shape](const Vector3& p) {
    const Vector3 flat = flattened(build, p);
    return smooth_max(shape(flat), sole_top - 0.05 - flat.y(), 0.2);
  };
  upper.inside = Vector3(0, 1.5, 11 * l);
  upper.box = roomy(foot);
  const Field topline = [build, l](const Vector3& p) {
    const Vector3 flat = flattened(build, p);
    const double back = std::clamp((1.0 - flat.z() / l) / 6.0, 0.0, 1.0);
    const double above_side = flat.y() - 2.9 - 2.9 * back * back * (3 - 2 * back);
    const double behind_throat = 10.6 * l - flat.z() - 0.10 * flat.x() * flat.x();
    return smooth_min(above_side, behind_throat, 3);
  };
  Tessellation how;
  how.lattice_spacing = 0.3;
  how.lattice_rotation = oblique_rotation(17);
  how.edges = {0.25, 0.9, 0.015, 8};
  return tessellate(upper, topline, how);
}

TriangleMesh shoe_sole(const FootBuild& build, const Anatomy& foot) {
  const Field shape = last(build, foot);
  const double l = build.length;
  Anatomy sole;
  sole.field = [build, shape, l](const Vector3& p) {
    const Vector3 flat = flattened(build, p);
    const double outline = shape({flat.x(), 0, flat.z()});
    const double slab =
        smooth_max(outline - 0.22,
                   std::abs(flat.y() - 0.5 * (sole_top + sole_bottom)) - 0.5 * (sole_top - sole_bottom), 0.3);
    const double height = p.y() - sole_bottom;
    const double front = flat.z() + 0.6 * l + 0.18 * (4 - height);
    const double block = smooth_max(smooth_max(outline + 0.1 * (3.4 - height), front, 0.4),
                                    std::max(sole_bottom - p.y(), flat.y() - sole_top + 0.2), 0.2);
    return smooth_min(slab, block, 0.5);
  };
  sole.inside = Vector3(0, 0.5 * (sole_top + sole_bottom), 12 * l);
  sole.box = roomy(foot);
  Tessellation how;
  how.lattice_spacing = 0.2;
  how.lattice_rotation = oblique_rotation(29);
  how.edges = {0.25, 1.0, 0.02, 8};
  return tessellate(sole, std::nullopt, how);
}

}  // namespace bespoke
