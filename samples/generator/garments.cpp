#include "garments.h"

#include <algorithm>
#include <cmath>

#include "tessellate.h"

namespace bespoke {
namespace {

// Garments are drawn on a mannequin of this height and scaled with it.
// Positive on the far side of the plane.
double beyond_plane(const Vector3& p, const Vector3& on_plane, const Vector3& normal) {
  return (p - on_plane).dot(normal.normalized());
}

// A smooth step from 0 at `from` to 1 at `to`.
double rise(double value, double from, double to) {
  const double s = std::clamp((value - from) / (to - from), 0.0, 1.0);
  return s * s * (3 - 2 * s);
}

Vector3 one_side(const Vector3& p) { return {std::abs(p.x()), p.y(), p.z()}; }

// Positive where the arm is to be left free, beside torso and skirt alike.
double beyond_armhole(const Vector3& p, double shoulder_width) {
  const Vector3 q = one_side(p);
  const double beside_shoulder = beyond_plane(q, {shoulder_width, 131, 0}, {1, 0.16, 0});
  const double beside_skirt = beyond_plane(q, {17.5, 112, 0}, {0.86, 0.5, 0});
  return smooth_min(beside_shoulder, beside_skirt, 5);
}

// Positive at the neck, inside half an oval that hangs from y = 143, deeper in front, and at the head.
double inside_neckline(const Vector3& p, double half_width, double front_depth) {
  const double depth = 6 + (front_depth - 6) * rise(p.z(), -3.5, 3.5);
  const double below = std::max(0.0, 143 - p.y()) / depth;
  const double inside = half_width * (1 - std::hypot(p.x() / half_width, below));
  return std::max(inside, p.y() - 145);
}

// Without it cloth would follow the body between the breasts and under them.
Solid bodice_bridge(const MannequinBuild& build) {
  Solid bridge;
  bridge.add(Ellipsoid{{0, 118.5, 4.0 * build.bust}, {12.5 * build.bust, 9.0, 6.4 * build.bust}}, 0.0);
  return bridge;
}

TriangleMesh sew(const Anatomy& cloth, const Field& cut, const MannequinBuild& build, double angle) {
  const double scale = build.height / standard_height;
  Tessellation how;
  how.lattice_spacing = 1.3 * scale;
  how.lattice_rotation = oblique_rotation(angle);
  how.edges = {0.9 * scale, 2.2 * scale, 0.05 * scale, 8};
  return tessellate(cloth, cut, how);
}

// The body's own surface at the given ease (cm), widened by the pattern, both in the standard mannequin's
// coordinates.
Anatomy around(const Anatomy& body, const MannequinBuild& build, double ease, const Field& pattern,
               double fillet) {
  const double scale = build.height / standard_height;
  const Field field = [inner = body.field, scale, ease, pattern, fillet](const Vector3& p) {
    return smooth_min(inner(p) - ease, scale * pattern(p / scale), fillet);
  };
  Box box = body.box;
  box.extend(Vector3(0, -8, 45));
  box.extend(Vector3(0, 0, -45));
  return {field, body.inside, box, {}};
}

Field scaled(const Field& standard, const MannequinBuild& build) {
  const double scale = build.height / standard_height;
  return [standard, scale](const Vector3& p) { return scale * standard(p / scale); };
}

}  // namespace

TriangleMesh dress(const MannequinBuild& build, const Anatomy& body) {
  const double h = build.hips;
  const double w = build.waist;
  constexpr double hem = 50;
  Solid skirt_part;
  skirt_part.add(Loft({{hem - 6, 0, 0, 30.5 * h, 27 * h, 27.5 * h},
                       {62, 0, 0, 27.0 * h, 23.5 * h, 24.0 * h},
                       {76, 0, 0, 22.4 * h, 18.5 * h, 19.2 * h},
                       {88, 0, 0, 18.0 * h, 13.4 * h, 14.0 * h},
                       {97, 0, 0.2, 14.2 * w, 10.0 * w, 9.6 * w},
                       {104, 0, 0.4, 12.0 * w, 8.3 * w, 7.4 * w}},
                      2, 2, 2.1),
                 0.0);
  const Solid bridge = bodice_bridge(build);
  const Field pattern = [skirt_part, bridge](const Vector3& p) {
    const double folds = 1.7 * rise(p.y(), 96, 56) * std::cos(11 * std::atan2(p.x(), p.z()));
    return smooth_min(skirt_part(p) - folds, bridge(p), 2);
  };
  const double s = build.shoulders;
  const Field cut = [s](const Vector3& p) {
    const double removed = smooth_max(beyond_armhole(p, 13.4 * s), inside_neckline(p, 9.0, 13.5), 1.0);
    return std::max(removed, hem - p.y());
  };
  return sew(around(body, build, 0.6, pattern, 2.5), scaled(cut, build), build, 31);
}

TriangleMesh top(const MannequinBuild& build, const Anatomy& body) {
  const double w = build.waist;
  const double b = build.bust;
  Solid fall;
  fall.add(Loft({{86, 0, 0.2, 16.9 * build.hips, 12.2 * build.hips, 13.4 * build.hips},
                 {96, 0, 0.2, 15.2 * w, 11.0 * w, 10.6 * w},
                 {104, 0, 0.3, 14.2 * w, 10.6 * w, 9.6 * w},
                 {112, 0, 0.4, 14.4 * b, 11.4 * b, 10.0 * b},
                 {119, 0, 0, 14.8 * b, 11.0 * b, 10.4 * b}},
                2, 2, 2.2),
           0.0);
  const Solid bridge = bodice_bridge(build);
  const Field pattern = [fall, bridge](const Vector3& p) { return smooth_min(fall(p), bridge(p), 2); };
  const Field cut = [s = build.shoulders](const Vector3& p) {
    const Vector3 q = one_side(p);
    const double sleeve_end = beyond_plane(q, {27.5 * s, 114.5, 0}, {0.62, -0.78, 0});
    const double sleeve = smooth_min(sleeve_end, beyond_plane(q, {20, 112, 0}, {0.86, 0.5, 0}), 0);
    return std::max({sleeve, inside_neckline(p, 8.6, 10), 95.0 - p.y()});
  };
  return sew(around(body, build, 1.3, pattern, 3), scaled(cut, build), build, 47);
}

TriangleMesh skirt(const MannequinBuild& build, const Anatomy& body) {
  const double h = build.hips;
  const double w = build.waist;
  constexpr double hem = 53;
  Solid shape;
  shape.add(Loft({{hem - 6, 0, 0, 23.5 * h, 17.5 * h, 18.5 * h},
                  {66, 0, 0, 21.2 * h, 15.0 * h, 16.0 * h},
                  {80, 0, 0, 18.6 * h, 11.8 * h, 13.4 * h},
                  {89, 0, 0, 16.8 * h, 10.0 * h, 11.4 * h},
                  {97, 0, 0.3, 13.6 * w, 9.0 * w, 8.4 * w},
                  {103, 0, 0.4, 11.6 * w, 8.1 * w, 7.2 * w}},
                 2, 2, 2.2),
            0.0);
  const Field pattern = [shape](const Vector3& p) {
    const double folds = 0.7 * rise(p.y(), 84, 58) * std::cos(8 * std::atan2(p.x(), p.z()));
    return shape(p) - folds;
  };
  const Field cut = [](const Vector3& p) {
    const double arm = beyond_plane(one_side(p), {22, 104, 0}, {0.86, 0.5, 0});
    return std::max({arm, p.y() - 103.5, hem - p.y()});
  };
  return sew(around(body, build, 0.5, pattern, 2.5), scaled(cut, build), build, 13);
}

}  // namespace bespoke
