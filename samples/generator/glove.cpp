#include <cmath>

#include "accessories.h"
#include "tessellate.h"

namespace bespoke {

TriangleMesh glove(const HandBuild& build, const Anatomy& hand) {
  constexpr double cuff_end = -5.5;
  const double w = build.palm_width;
  const double t = build.thickness;
  Solid cuff;
  cuff.add(Loft({{cuff_end - 2, 0, -0.1, 4.5 * w, 3.3 * t, 3.3 * t},
                 {-4, 0, -0.1, 3.9 * w, 2.8 * t, 2.8 * t},
                 {-1.2, 0, -0.1, 3.0 * w, 2.1 * t, 2.1 * t},
                 {0, 0, 0, 2.7 * w, 1.8 * t, 1.8 * t}},
                1, 1, 2.2),
           0.0);
  Anatomy leather;
  leather.field = [inner = hand.field, cuff](const Vector3& p) {
    // A raised seam ends the cuff.
    const double seam = 0.18 * std::exp(-4 * (p.y() - cuff_end - 0.45) * (p.y() - cuff_end - 0.45));
    return smooth_min(inner(p) - 0.2, cuff(p), 0.8) - seam;
  };
  leather.inside = hand.inside;
  leather.box = hand.box;
  leather.box.extend(Vector3(0, cuff_end - 6, 0));
  Tessellation how;
  how.lattice_spacing = 0.2;
  how.lattice_rotation = oblique_rotation(21);
  how.edges = {0.22, 0.9, 0.015, 8};
  return tessellate(
      leather, [](const Vector3& p) { return cuff_end - p.y(); }, how);
}

}  // namespace bespoke
