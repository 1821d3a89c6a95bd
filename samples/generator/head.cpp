#include "head.h"

#include <cmath>

namespace bespoke {
namespace {

void add_face(Solid& head, const HeadBuild& build) {
  const double w = build.width;
  const double j = build.width * build.jaw;
  const double h = build.face;
  head.add(Loft({{-10.2 * h, 0, 5.9, 1.9 * j, 2.0, 3.0},
                 {-9.0 * h, 0, 5.0, 3.0 * j, 3.1, 4.4},
                 {-6.3 * h, 0, 3.0, 4.9 * j, 4.9, 5.0},
                 {-3.0 * h, 0, 2.0, 6.0 * w, 5.9, 6.0},
                 {0, 0, 1.5, 6.5 * w, 6.3, 7.0},
                 {3, 0, 1.0, 6.5 * w, 6.5, 7.0},
                 {6, 0, 0.5, 5.6 * w, 5.8, 6.5}},
                0.9, 2.0, 2.15),
           2.5);
  head.add_both(RoundCone{{{1.3 * j, -9.0 * h, 5.9}, 1.4}, {{4.2 * j, -5.9 * h, 0.2}, 1.35}}, 2.5);
  head.add_both(RoundCone{{{4.2 * j, -5.9 * h, 0.2}, 1.35}, {{5.4 * w, -0.5, -1.2}, 1.3}}, 2.5);
  head.add_both(Ellipsoid{{4.3 * w, -1.0 * h, 5.0}, {2.0, 1.3, 1.8}}, 2.5);
}

void add_eyes(Solid& head, const HeadBuild& build) {
  const double x = 3.15 * build.width;
  head.carve_both(Ellipsoid{{x, 0.9, 9.2}, {2.0, 1.2, 2.0}}, 1.6);
  head.add_both(RoundCone{{{1.7, 2.6, 7.6}, 0.5}, {{4.6 * build.width, 2.9, 6.2}, 0.35}}, 1.6);
  head.add_both(Ellipsoid{{x, 0.75, 6.75}, {1.5, 1.0, 1.05}}, 0.4);
}

void add_nose(Solid& head, const HeadBuild& build) {
  const double out = build.nose;
  const double h = build.face;
  head.add(Loft({{-3.3 * h, 0, 7.0, 1.05, 2.2 * out + 0.6, 2},
                 {-2.6 * h, 0, 7.0, 1.05, 2.9 * out + 0.9, 2},
                 {-1.2 * h, 0, 7.0, 0.8, 2.3 * out + 0.8, 2},
                 {0.5, 0, 7.0, 0.65, 1.4 * out + 0.7, 2},
                 {2.2, 0, 7.0, 0.75, 1.3, 2}},
                0.5, 1.5),
           1.0);
  head.add_both(Ellipsoid{{1.05, -2.95 * h, 7.9 + 0.8 * out}, {0.6, 0.6, 0.95}}, 0.6);
  head.carve_both(Ellipsoid{{0.6, -3.75 * h, 8.1 + 0.9 * out}, {0.3, 0.3, 0.5}}, 0.35);
}

void add_mouth(Solid& head, const HeadBuild& build) {
  const double h = build.face;
  head.add(Ellipsoid{{0, -5.9 * h, 6.4}, {2.9, 1.7, 1.5}}, 1.8);
  head.add_both(RoundCone{{{0.3, -5.45 * h, 8.0}, 0.33}, {{2.2, -5.8 * h, 7.15}, 0.2}}, 0.6);
  head.add(RoundCone{{{-0.8, -6.35 * h, 7.85}, 0.42}, {{0.8, -6.35 * h, 7.85}, 0.42}}, 0.5);
  head.add_both(RoundCone{{{0.8, -6.35 * h, 7.85}, 0.42}, {{2.2, -5.95 * h, 7.15}, 0.2}}, 0.6);
  head.carve(Ellipsoid{{0, -7.5 * h, 9.1}, {1.6, 0.55, 1.0}}, 1.2);
  head.add(Ellipsoid{{0, -9.5 * h, 6.6}, {1.6, 1.1, 1.5}}, 1.5);
}

void add_ears(Solid& head, const HeadBuild& build) {
  Solid ear;
  ear.add(Ellipsoid{{0, 0, 0}, {0.55, 3.1, 1.75}}, 0.0);
  ear.carve(Ellipsoid{{0.75, 0.3, 0.15}, {0.75, 2.1, 1.05}}, 0.35);
  ear.add(RoundCone{{{0.3, 1.4, -0.8}, 0.28}, {{0.25, -1.2, -0.35}, 0.25}}, 0.3);
  ear.add(Ellipsoid{{0.1, -2.4, 0.3}, {0.5, 0.8, 0.7}}, 0.9);
  Eigen::Affine3d head_from_ear = Eigen::Affine3d::Identity();
  head_from_ear.translate(Vector3(7.25 * build.width, -0.6, -1.6));
  head_from_ear.rotate(Eigen::AngleAxisd(-0.32, Vector3::UnitY()));
  head_from_ear.rotate(Eigen::AngleAxisd(-0.12, Vector3::UnitX()));
  head_from_ear.scale(build.ears);
  head.add(ear, head_from_ear, 1.0);
  head.add(ear, Eigen::Affine3d(Eigen::Scaling(-1.0, 1.0, 1.0)) * head_from_ear, 1.0);
}

}  // namespace

Solid skull(const HeadBuild& build) {
  Solid head;
  head.add(Ellipsoid{{0, 3.2, -1.0}, {7.4 * build.width, 8.3, 9.3 * build.length}}, 0.0);
  add_face(head, build);
  add_eyes(head, build);
  add_nose(head, build);
  add_mouth(head, build);
  return head;
}

Anatomy display_head(const HeadBuild& build) {
  const double base = -19.0;
  Solid solid = skull(build);
  add_ears(solid, build);
  const double w = build.width;
  solid.add(Loft({{base - 3, 0, -3.6, 9.5 * w, 8.0, 7.5},
                  {base + 1, 0, -3.4, 8.2 * w, 7.0, 6.8},
                  {-15.5, 0, -3.1, 5.6 * w, 5.6, 5.5},
                  {-11, 0, -2.5, 5.0 * w, 5.2, 5.2},
                  {-5, 0, -2.0, 5.0 * w, 5.0, 6.0}},
                 2, 3),
            3.0);
  Anatomy head;
  head.field = [solid, base](const Vector3& p) { return smooth_max(solid(p), base - p.y(), 0.8); };
  head.inside = Vector3(0, 3, 0);
  head.box = Box(Vector3(-13, base - 2, -14), Vector3(13, 14, 15));

  const auto mark = [&](const std::string& name, const Vector3& inside, const Vector3& direction) {
    head.landmarks.push_back({name, leave(head.field, inside, direction)});
  };
  const auto mark_both = [&](const std::string& name, const Vector3& inside, const Vector3& direction) {
    const Vector3 other(-1, 1, 1);
    mark("left_" + name, inside, direction);
    mark("right_" + name, inside.cwiseProduct(other), direction.cwiseProduct(other));
  };
  const double h = build.face;
  const Vector3 front = Vector3::UnitZ();
  const Vector3 left = Vector3::UnitX();
  mark("crown", {0, 5, -1}, {0, 1, 0});
  mark("forehead", {0, 6.5, 0}, front);
  mark("nasion", {0, 2.0, 0}, front);
  mark("nose_tip", {0, -2.7 * h, 5}, front);
  mark("upper_lip", {0, -5.35 * h, 4}, front);
  mark("chin", {0, -9.6 * h, 5}, front);
  mark("chin_bottom", {0, -9.0 * h, 6.2}, {0, -1, 0});
  mark("throat", {0, -14, -2.5}, front);
  mark("nape", {0, -11, -2.5}, -front);
  mark("occiput", {0, 3, 0}, -front);
  mark("base_front", {0, -18, -3}, front);
  mark("base_back", {0, -18, -3}, -front);
  mark_both("temple", {0, 3.5, 2.5}, left);
  mark_both("parietal", {0, 6, -2.5}, left);
  mark_both("brow", {3.2 * w, 2.9, 4}, front);
  mark_both("eye", {3.15 * w, 0.75, 5}, front);
  mark_both("cheekbone", {3.0 * w, -1.4 * h, 3.5}, {0.75, 0, 0.66});
  mark_both("nose_wing", {0.5, -3.0 * h, 8.1 + 1.1 * build.nose}, left);
  mark_both("mouth_corner", {2.1, -5.9 * h, 4}, front);
  mark_both("jaw_angle", {4 * build.jaw * w, -5.8 * h, 0.2}, {1, -0.35, 0});
  mark_both("ear_root", {3, 2.6 * build.ears - 0.6, -0.6}, left);
  const Vector3 ear(7.25 * w, -0.6, -1.6);
  mark_both("ear_top", ear + Vector3(0, 2.6 * build.ears, -0.3), {0, 1, -0.1});
  mark_both("ear_lobe", ear + Vector3(0.1, -2.4 * build.ears, 0.3), {0, -1, 0});
  mark_both("neck_side", {0, -14, -3}, left);
  mark_both("base_side", {0, -18, -3.4}, left);
  return head;
}

}  // namespace bespoke
