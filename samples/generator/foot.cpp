#include "foot.h"

#include <algorithm>
#include <cmath>

namespace bespoke {
namespace {

constexpr double shin_end = 21;
constexpr double heel_height = 3.6;

// From the heel to the roots of the toes.
Solid arch(const FootBuild& build) {
  const double w = build.width;
  const double l = build.length;
  const double h = build.instep;
  Solid lengthwise;
  lengthwise.add(Loft({{-4.6 * l, 0, 2.4, 2.4 * w, 1.9, 2.2},
                       {-2.5 * l, 0, 2.7, 3.0 * w, 3.0, 2.7},
                       {0.5 * l, 0.1, 3.0, 3.1 * w, 3.6 * h, 3.0},
                       {4 * l, 0.3, 3.0, 3.2 * w, 3.4 * h, 2.7},
                       {8 * l, 0.3, 2.4, 3.7 * w, 2.5 * h, 2.3},
                       {11.5 * l, 0.1, 1.8, 4.3 * w, 1.8 * h, 1.9},
                       {13.6 * l, -0.1, 1.4, 4.1 * w, 1.1 * h, 1.5},
                       {14.6 * l, -0.5, 1.2, 3.5 * w, 0.8 * h, 1.2}},
                      1.3, 0.8, 2.15),
                 0.0);
  Solid solid;
  solid.add(lengthwise, lying(), 0.0);
  return solid;
}

Solid foot_solid(const FootBuild& build) {
  const double w = build.width;
  const double l = build.length;
  const double a = build.ankle;
  Solid solid = arch(build);
  solid.add(Loft({{3.5, 0.1, -1.2, 2.6 * a, 3.2, 3.2},
                  {6, 0.1, -1.3, 2.7 * a, 3.2 * a, 3.2 * a},
                  {8.5, 0.1, -1.5, 2.7 * a, 2.9 * a, 3.2 * a},
                  {11, 0.1, -1.6, 2.75 * a, 2.9 * a, 3.2 * a},
                  {15, 0.1, -1.7, 3.4 * a, 3.4 * a, 4.0 * a},
                  {shin_end + 3, 0.1, -1.9, 4.6 * a, 4.3 * a, 5.6 * a}},
                 2, 3),
            3.0);
  solid.add(Ellipsoid{{-1.75 * a, 7.6, -0.7}, {1.3, 1.4, 1.4}}, 1.6);
  solid.add(Ellipsoid{{1.9 * a, 6.8, -1.4}, {1.3, 1.5, 1.3}}, 1.6);
  const auto toe = [&](const Vector3& root, double root_radius, const Vector3& tip, double tip_radius) {
    const Vector3 scale(w, 1, l);
    solid.add(RoundCone{{root.cwiseProduct(scale), root_radius}, {tip.cwiseProduct(scale), tip_radius}},
              0.35);
    solid.add(Ellipsoid{tip.cwiseProduct(scale), {1.04 * tip_radius, 0.95 * tip_radius, 1.15 * tip_radius}},
              0.3);
  };
  toe({-2.55, 1.35, 13.2}, 1.2, {-2.85, 1.1, 17.2}, 1.02);
  toe({-0.75, 1.2, 13.6}, 0.82, {-0.72, 0.8, 17.3}, 0.63);
  toe({0.8, 1.1, 13.2}, 0.78, {0.83, 0.72, 16.5}, 0.59);
  toe({2.15, 1.05, 12.6}, 0.76, {2.33, 0.68, 15.5}, 0.56);
  toe({3.3, 0.95, 11.6}, 0.76, {3.75, 0.64, 14.1}, 0.55);
  return solid;
}

}  // namespace

Eigen::Affine3d lying() {
  Eigen::Affine3d swap = Eigen::Affine3d::Identity();
  swap.linear() << 1, 0, 0, 0, 0, 1, 0, 1, 0;
  return swap;
}

Solid stockinged_foot(const FootBuild& build) {
  const double w = build.width;
  const double l = build.length;
  Solid solid = arch(build);
  solid.add(RoundCone{{{-1.9 * w, 1.3, 12 * l}, 1.5}, {{-1.8 * w, 1.0, 16.3 * l}, 1.25}}, 1.5);
  solid.add(RoundCone{{{0.4 * w, 1.2, 12 * l}, 1.4}, {{0.1 * w, 0.9, 16.4 * l}, 1.1}}, 1.5);
  solid.add(RoundCone{{{2.6 * w, 1.1, 11 * l}, 1.3}, {{2.2 * w, 0.9, 14.2 * l}, 1.1}}, 1.5);
  return solid;
}

double heel_lift(const FootBuild& build, double z) {
  const double s = std::clamp((11.5 - z / build.length) / 15.0, 0.0, 1.0);
  return heel_height * s * s * (3 - 2 * s);
}

Anatomy foot(const FootBuild& build) {
  const Solid solid = foot_solid(build);
  Anatomy model;
  model.field = [solid, build](const Vector3& p) {
    const Vector3 flat(p.x(), p.y() - heel_lift(build, p.z()), p.z());
    return smooth_max(smooth_max(solid(flat), -flat.y(), 0.5), p.y() - shin_end, 0.5);
  };
  const double l = build.length;
  model.inside = Vector3(0, 14, -1.5);
  model.box = Box(Vector3(-8, -1, -9 * l), Vector3(8, shin_end + 1, 21 * l));

  const auto mark = [&](const std::string& name, Vector3 inside, const Vector3& direction) {
    inside.y() += heel_lift(build, inside.z());
    model.landmarks.push_back({name, leave(model.field, inside, direction)});
  };
  const Vector3 front = Vector3::UnitZ();
  const Vector3 outside = Vector3::UnitX();
  const Vector3 up = Vector3::UnitY();
  const double w = build.width;
  const double a = build.ankle;
  mark("big_toe", {-2.85 * w, 1.1, 17.2 * l}, front);
  mark("second_toe", {-0.72 * w, 0.8, 17.3 * l}, front);
  mark("third_toe", {0.83 * w, 0.72, 16.5 * l}, front);
  mark("fourth_toe", {2.33 * w, 0.68, 15.5 * l}, front);
  mark("little_toe", {3.75 * w, 0.64, 14.1 * l}, front);
  mark("big_toe_top", {-2.85 * w, 1.1, 16.8 * l}, up);
  mark("ball_inside", {0, 1.5, 11.5 * l}, -outside);
  mark("ball_outside", {0, 1.2, 11 * l}, outside);
  mark("ball_top", {0, 1.5, 11.5 * l}, up);
  mark("ball_sole", {0, 1.5, 11.5 * l}, -up);
  mark("waist_inside", {0, 2.4, 5 * l}, -outside);
  mark("waist_outside", {0, 2.4, 5 * l}, outside);
  mark("waist_sole", {0, 2.4, 5 * l}, -up);
  mark("instep", {0, 3, 5.5 * l}, up);
  mark("heel_back", {0, 2.4, -3 * l}, -front);
  mark("heel_inside", {0, 2.4, -2.5 * l}, -outside);
  mark("heel_outside", {0, 2.4, -2.5 * l}, outside);
  mark("heel_sole", {0, 2.4, -2.5 * l}, -up);
  mark("ankle_front", {0, 7.5, -1.5}, front);
  mark("ankle_back", {0, 8.5, -1.5}, -front);
  mark("ankle_inside", {-1.5 * a, 7.6, -0.7}, -outside);
  mark("ankle_outside", {1.5 * a, 6.8, -1.4}, outside);
  mark("shin_front", {0, 15.5, -1.7}, front);
  mark("shin_back", {0, 15.5, -1.7}, -front);
  mark("shin_inside", {0, 15.5, -1.7}, -outside);
  mark("shin_outside", {0, 15.5, -1.7}, outside);
  return model;
}

}  // namespace bespoke
