#include "hand.h"

#include <array>
#include <cmath>

namespace bespoke {
namespace {

constexpr double forearm_end = -8;
// Joint centres from knuckle to tip, and the radius at each.
struct Finger {
  std::string name;
  std::array<Vector3, 4> joints;
  std::array<double, 4> radii;
};

Finger finger(const std::string& name, const Vector3& knuckle, double length, double lean, double radius) {
  const Vector3 along(std::sin(lean), std::cos(lean), 0);
  const Vector3 bend(0, 0, 1);
  Finger made{name, {}, {1.06 * radius, radius, 0.92 * radius, 0.74 * radius}};
  made.joints[0] = knuckle;
  made.joints[1] = knuckle + 0.48 * length * along + 0.03 * length * bend;
  made.joints[2] = knuckle + 0.76 * length * along + 0.08 * length * bend;
  made.joints[3] = knuckle + 0.95 * length * along + 0.14 * length * bend;
  return made;
}

std::array<Finger, 5> fingers_of(const HandBuild& build) {
  const double w = build.palm_width;
  const double l = build.palm_length;
  const double f = build.finger_length;
  const double t = build.thickness;
  const double s = build.spread * degree;
  Finger thumb{"thumb",
               {Vector3(2.0 * w, 2.0 * l, 0.7), Vector3(4.0 * w, 5.2 * l, 1.5),
                Vector3(5.1 * w, 5.2 * l + 2.9 * f, 1.7), Vector3(5.7 * w, 5.2 * l + 5.2 * f, 1.6)},
               {1.35 * t, 1.08 * t, 0.95 * t, 0.78 * t}};
  return {thumb, finger("index", {2.75 * w, 9.1 * l, 0}, 7.1 * f, 9 * s, 0.83 * t),
          finger("middle", {0.92 * w, 9.5 * l, -0.1}, 7.9 * f, 2 * s, 0.85 * t),
          finger("ring", {-0.92 * w, 9.1 * l, -0.05}, 7.3 * f, -5 * s, 0.8 * t),
          finger("little", {-2.65 * w, 8.2 * l, 0.1}, 5.7 * f, -13 * s, 0.68 * t)};
}

Solid hand_solid(const HandBuild& build) {
  const double w = build.palm_width;
  const double l = build.palm_length;
  const double t = build.thickness;
  Solid solid;
  solid.add(Loft({{forearm_end - 2, 0, -0.2, 3.4 * w, 2.5 * t, 2.4 * t},
                  {-4, 0, -0.2, 2.9 * w, 2.0 * t, 2.0 * t},
                  {-0.5, 0, -0.1, 2.6 * w, 1.75 * t, 1.75 * t},
                  {2, 0, 0, 2.9 * w, 1.6 * t, 1.6 * t},
                  {5 * l, 0, 0, 3.5 * w, 1.35 * t, 1.4 * t},
                  {7.5 * l, 0.05, 0, 3.6 * w, 1.15 * t, 1.25 * t},
                  {8.8 * l, 0.05, 0, 3.4 * w, 0.95 * t, 1.0 * t}},
                 2, 1.0, 2.3),
            0.0);
  solid.add(Ellipsoid{{2.0 * w, 3.4 * l, 1.0 * t}, {1.6, 2.9, 1.1}}, 1.2);
  solid.add(Ellipsoid{{-2.2 * w, 3.6 * l, 0.8 * t}, {1.3, 3.0, 0.9}}, 1.2);
  for (const Finger& finger : fingers_of(build)) {
    const bool thumb = finger.name == "thumb";
    solid.add(RoundCone{{finger.joints[0], finger.radii[0]}, {finger.joints[1], finger.radii[1]}},
              thumb ? 1.4 : 0.45);
    solid.add(RoundCone{{finger.joints[1], finger.radii[1]}, {finger.joints[2], finger.radii[2]}}, 0.3);
    solid.add(RoundCone{{finger.joints[2], finger.radii[2]}, {finger.joints[3], finger.radii[3]}}, 0.3);
    if (!thumb) solid.add(Ellipsoid{finger.joints[0] + Vector3(0, -0.2, -0.65 * t), {0.75, 0.9, 0.6}}, 0.8);
  }
  return solid;
}

}  // namespace

Anatomy hand(const HandBuild& build) {
  const Solid solid = hand_solid(build);
  Anatomy model;
  model.field = [solid](const Vector3& p) { return smooth_max(solid(p), forearm_end - p.y(), 0.5); };
  model.inside = Vector3(0, 0, 0);
  const Vector3 reach(8.5 * build.palm_width, 10 * build.palm_length + 8.5 * build.finger_length + 1, 5);
  model.box = Box(Vector3(-reach.x(), forearm_end - 1, -reach.z()), reach);

  const auto mark = [&](const std::string& name, const Vector3& inside, const Vector3& direction) {
    model.landmarks.push_back({name, leave(model.field, inside, direction)});
  };
  const Vector3 front = Vector3::UnitZ();
  const Vector3 side = Vector3::UnitX();
  for (const Finger& finger : fingers_of(build)) {
    mark(finger.name + "_tip", finger.joints[3], finger.joints[3] - finger.joints[2]);
    mark(finger.name + "_end_joint_back", finger.joints[2], -front);
    mark(finger.name + "_end_joint_front", finger.joints[2], front);
    mark(finger.name + "_middle_joint_back", finger.joints[1], -front);
    mark(finger.name + "_middle_joint_front", finger.joints[1], front);
    if (finger.name != "thumb") mark(finger.name + "_knuckle", finger.joints[0], -front);
  }
  const double l = build.palm_length;
  mark("palm", {0, 5 * l, 0}, front);
  mark("palm_thumb_side", {1.5, 7.4 * l, 0}, side);
  mark("palm_little_side", {-1, 5 * l, 0}, -side);
  mark("wrist_front", {0, 0, 0}, front);
  mark("wrist_back", {0, 0, 0}, -front);
  mark("wrist_thumb_side", {0, 0, 0}, side);
  mark("wrist_little_side", {0, 0, 0}, -side);
  mark("forearm_front", {0, -6.5, 0}, front);
  mark("forearm_back", {0, -6.5, 0}, -front);
  mark("forearm_thumb_side", {0, -6.5, 0}, side);
  mark("forearm_little_side", {0, -6.5, 0}, -side);
  return model;
}

}  // namespace bespoke
