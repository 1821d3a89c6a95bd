#include "mannequin.h"

#include "foot.h"
#include "head.h"

#include <cmath>

namespace bespoke {
namespace {

// All shapes are built for this height and then scaled.
constexpr double standard_hip_height = 84;

const Vector3 shoulder(15.8, 130.2, -1.6);
const Vector3 wrist(44.0, 89.5, 1.2);

void add_torso(Solid& body, const MannequinBuild& build) {
  const double s = build.shoulders;
  const double b = build.bust;
  const double w = build.waist;
  const double h = build.hips;
  const double belly = build.belly;
  body.add(Loft({{76, 0, -0.5, 13.0 * h, 7.5 * h, 8.0 * h},
                 {80, 0, -0.4, 16.2 * h, 8.8 * h, 9.6 * h},
                 {84, 0, -0.3, 17.0 * h, 9.2 * h + 0.3 * belly, 10.2 * h},
                 {89, 0, 0, 16.2 * h, 9.3 * h + 0.7 * belly, 9.6 * h},
                 {95, 0, 0.3, 13.9 * (0.4 * h + 0.6 * w), 8.9 * w + belly, 8.2 * (0.4 * h + 0.6 * w)},
                 {103.5, 0, 0.4, 11.6 * w, 8.1 * w + 0.8 * belly, 7.2 * w},
                 {111, 0, 0.3, 12.9 * (0.4 * w + 0.6 * b), 8.8 * b + 0.2 * belly, 8.5 * b},
                 {119, 0, 0, 14.4 * b, 8.9 * b, 9.6 * b},
                 {125, 0, -0.5, 15.3 * b * s, 8.3 * b, 9.4 * b},
                 {130, 0, -1.2, 15.6 * s, 7.0 * b, 8.4 * b},
                 {133.5, 0, -1.7, 14.2 * s, 5.8, 7.0},
                 {136.5, 0, -2.0, 10.2 * s, 5.0, 6.0},
                 {139.5, 0, -2.0, 6.6, 4.7, 5.4},
                 {143, 0, -1.4, 4.7, 4.3, 4.6}},
                3, 3, 2.3),
           0.0);
  body.add_both(Ellipsoid{{7.6 * h, 83.0, -6.2 * h}, {6.6 * h, 7.2, 5.6 * h}}, 5.0);
  const double r = 5.2 * build.breasts * std::sqrt(b);
  body.add_both(Ellipsoid{{7.5 * b, 117.6, 7.0 * b}, {r * 1.05, r, r * 0.95}}, 3.6);
  body.add_both(Ellipsoid{{7.7 * b, 123.5, 5.2 * b}, {4.4, 6.0, 3.2}}, 4.5);
}

void add_neck_and_head(Solid& body) {
  body.add(RoundCone{{{0, 136, -2.2}, 5.0}, {{0, 148, 0.2}, 4.7}}, 3.0);
  Eigen::Affine3d body_from_head = Eigen::Affine3d::Identity();
  body_from_head.translate(Vector3(0, 154.3, 1.3));
  body_from_head.scale(0.93);
  body.add(skull({}), body_from_head, 1.6);
}

// A thumb and the fingers in one piece, as on a display mannequin, in the frame of the forearm: -y to the
// tips, x to the back of the hand, z to the thumb.
Solid mannequin_hand() {
  Solid hand;
  hand.add(Loft({{-14.6, -1.2, 0, 1.05, 2.4, 2.7},
                 {-11.5, -0.5, 0.1, 1.2, 2.9, 3.1},
                 {-8.6, 0.05, 0.1, 1.45, 3.4, 3.5},
                 {-4.5, 0.1, 0.1, 1.6, 3.3, 3.3},
                 {0, 0, 0, 1.9, 2.5, 2.5}},
                1.9, 2.0),
           0.0);
  hand.add(RoundCone{{{-0.3, -2.2, 1.9}, 1.4}, {{-0.8, -5.3, 4.5}, 1.3}}, 1.8);
  hand.add(RoundCone{{{-0.8, -5.3, 4.5}, 1.3}, {{-1.2, -8.4, 6.3}, 1.1}}, 1.0);
  return hand;
}

const Vector3 middle_fingertip(-1.2, -15.0, 0.0);  // in the frame of the hand

Eigen::Affine3d arm_from_hand() {
  Eigen::Affine3d frame = Eigen::Affine3d::Identity();
  frame.translate(Vector3(0, -(wrist - shoulder).norm(), 0));
  frame.rotate(Eigen::AngleAxisd(-0.10, Vector3::UnitZ()));
  frame.scale(0.97);
  return frame;
}

// The arm's own frame: shoulder joint at the origin, wrist on the negative y axis.
Eigen::Affine3d body_from_arm(const MannequinBuild& build) {
  const Vector3 down = -Vector3::UnitY();
  const Vector3 arm = (wrist - shoulder).normalized();
  Eigen::Affine3d frame = Eigen::Affine3d::Identity();
  frame.translate(shoulder.cwiseProduct(Vector3(build.shoulders, 1, 1)));
  frame.rotate(Eigen::AngleAxisd(std::acos(down.dot(arm)), down.cross(arm).normalized()));
  return frame;
}

void add_arms(Solid& body, const MannequinBuild& build) {
  const double l = build.limbs;
  const double length = (wrist - shoulder).norm();
  Solid arm;
  arm.add(Loft({{-length - 1, 0, 0, 2.35 * l, 2.7 * l, 2.7 * l},
                {-length + 3, 0, 0, 2.5 * l, 2.8 * l, 2.8 * l},
                {-0.80 * length, 0.1, 0.1, 3.2 * l, 3.4 * l, 3.2 * l},
                {-0.63 * length, 0.4, -0.2, 3.9 * l, 3.9 * l, 3.7 * l},
                {-0.53 * length, 0.6, -0.8, 3.7 * l, 3.6 * l, 3.5 * l},
                {-0.38 * length, 0.4, -0.5, 4.2 * l, 4.4 * l, 4.2 * l},
                {-0.18 * length, 0.2, -0.2, 4.5 * l, 4.9 * l, 4.8 * l},
                {-3, 0.3, 0, 4.6 * l, 5.1 * l, 5.1 * l},
                {0, 0, 0, 4.2 * l, 4.8 * l, 4.8 * l}},
               1, 2.6),
          0.0);
  arm.add(mannequin_hand(), arm_from_hand(), 1.0);
  body.add(arm, body_from_arm(build), 7.0);
  body.add(arm, Eigen::Affine3d(Eigen::Scaling(-1.0, 1.0, 1.0)) * body_from_arm(build), 7.0);
}

// The left foot's own frame: ankle above the origin, toes to z.
Eigen::Affine3d body_from_foot() {
  Eigen::Affine3d frame = Eigen::Affine3d::Identity();
  frame.translate(Vector3(8.0, 0, -2.2));
  frame.rotate(Eigen::AngleAxisd(0.12, Vector3::UnitY()));
  frame.scale(0.98);
  return frame;
}

void add_legs(Solid& body, const MannequinBuild& build) {
  const double l = build.limbs;
  const double h = build.hips;
  const double t = 0.5 * (l + h);
  body.add_both(Loft({{5, 8.0, -3.2, 2.6 * l, 3.3 * l, 3.2 * l},
                      {10, 8.1, -3.0, 2.75 * l, 3.0 * l, 3.4 * l},
                      {15, 8.2, -2.8, 3.2 * l, 3.3 * l, 3.9 * l},
                      {25, 8.4, -2.4, 4.7 * l, 4.2 * l, 5.5 * l},
                      {33, 8.5, -2.0, 5.2 * l, 4.7 * l, 6.1 * l},
                      {40, 8.4 + 1.5 * (t - 1), -1.2, 4.8 * l, 5.0 * l, 5.2 * l},
                      {46, 8.3 + 2 * (t - 1), -0.5, 4.9 * l, 5.4 * l, 4.8 * l},
                      {53, 8.5 + 4 * (t - 1), -0.2, 5.7 * t, 6.3 * t, 5.8 * t},
                      {64, 7.1 * t + 1.8, -0.1, 7.1 * t, 7.8 * t, 7.4 * t},
                      {74, 7.8 * h + 1.2, -0.2, 7.8 * h, 8.6 * h, 8.7 * h},
                      {82, 7.9 * h + 0.8, -0.3, 7.9 * h, 8.4 * h, 8.8 * h}},
                     3, 7),
                4.0);
  const Solid foot = stockinged_foot({1, l, 1, l});
  body.add(foot, body_from_foot(), 2.5);
  body.add(foot, Eigen::Affine3d(Eigen::Scaling(-1.0, 1.0, 1.0)) * body_from_foot(), 2.5);
}

void add_landmarks(Anatomy& body, const MannequinBuild& build) {
  const double scale = build.height / standard_height;
  const auto mark = [&](const std::string& name, const Vector3& inside, const Vector3& direction) {
    body.landmarks.push_back({name, leave(body.field, scale * inside, direction)});
  };
  const auto mark_both = [&](const std::string& name, const Vector3& inside, const Vector3& direction) {
    const Vector3 other(-1, 1, 1);
    mark("left_" + name, inside, direction);
    mark("right_" + name, inside.cwiseProduct(other), direction.cwiseProduct(other));
  };
  const Vector3 front = Vector3::UnitZ();
  const Vector3 left = Vector3::UnitX();
  const Vector3 arm = wrist - shoulder;
  const Vector3 across = Vector3(-arm.y(), arm.x(), 0).normalized();
  Vector3 joint = shoulder;
  joint.x() *= build.shoulders;
  mark("crown", {0, 158, 0}, {0, 1, 0});
  mark("nose", {0, 151.8, 5}, front);
  mark("chin", {0, 145.4, 5}, front);
  mark("neck_front", {0, 142, -1}, front);
  mark("neck_back", {0, 142, -1}, -front);
  mark("sternum", {0, 119, 0}, front);
  mark("upper_back", {0, 126, 0}, -front);
  mark("waist_front", {0, 103.5, 0}, front);
  mark("waist_back", {0, 103.5, 0}, -front);
  mark("hip_front", {0, 86, 0}, front);
  mark("hip_back", {0, 86, 0}, -front);
  mark_both("shoulder", joint, {0.35, 1, 0});
  mark_both("bust", {7.4 * build.bust, 118, 7}, front);
  mark_both("waist_side", {0, 103.5, 0.4}, left);
  mark_both("hip_side", {0, standard_hip_height, 0}, left);
  mark_both("buttock", {7.6 * build.hips, 83.5, -4}, -front);
  mark_both("elbow_outside", joint + 0.53 * arm, across);
  mark_both("wrist_outside", joint + 0.97 * arm, across);
  mark_both("fingertip", body_from_arm(build) * arm_from_hand() * middle_fingertip, arm);
  mark_both("knee_front", {8.3, 46, 0}, front);
  mark_both("knee_back", {8.3, 46, -1}, -front);
  mark_both("ankle_outside", {8.0, 9, -3}, left);
  mark_both("ankle_inside", {8.0, 9, -3}, -left);
  mark_both("heel", body_from_foot() * Vector3(0, 2.4, -3), body_from_foot().linear() * -front);
  mark_both("toe", body_from_foot() * Vector3(-0.8, 1.1, 14), body_from_foot().linear() * front);
}

}  // namespace

Anatomy mannequin(const MannequinBuild& build) {
  Solid standard;
  add_torso(standard, build);
  add_neck_and_head(standard);
  add_arms(standard, build);
  add_legs(standard, build);
  const double scale = build.height / standard_height;
  Solid solid;
  solid.add(standard, Eigen::Affine3d(Eigen::Scaling(scale)), 0.0);

  Anatomy body;
  body.field = [solid](const Vector3& p) { return smooth_max(solid(p), -p.y(), 0.6); };
  body.inside = scale * Vector3(0, 100, 0);
  body.box = Box(scale * Vector3(-66, -4, -24), scale * Vector3(66, 170, 26));
  add_landmarks(body, build);
  return body;
}

double hip_height(const MannequinBuild& build) {
  return standard_hip_height * build.height / standard_height;
}

double hip_girth(const MannequinBuild& build, const Field& mannequin_field) {
  const int rays = 720;
  const Vector3 centre(0, hip_height(build), 0);
  std::vector<Vector3> outline;
  for (int i = 0; i < rays; ++i) {
    const double angle = 2 * 3.14159265358979323846 * i / rays;
    outline.push_back(leave(mannequin_field, centre, {std::cos(angle), 0, std::sin(angle)}));
  }
  double length = 0;
  for (int i = 0; i < rays; ++i) length += (outline[(i + 1) % rays] - outline[i]).norm();
  return length;
}

MannequinBuild graded_build(double height, double girth) {
  const auto graded = [&](double factor) {
    MannequinBuild build;
    build.height = height;
    build.hips = factor;
    build.waist = 1 + 1.15 * (factor - 1);
    build.bust = 1 + 0.85 * (factor - 1);
    build.belly = std::max(0.0, 12 * (factor - 1));
    build.limbs = 1 + 0.7 * (factor - 1);
    return build;
  };
  const auto miss = [&](double factor) {
    const MannequinBuild build = graded(factor);
    return hip_girth(build, mannequin(build).field) - girth;
  };
  double before = 0.95;
  double now = 1.05;
  double miss_before = miss(before);
  for (int step = 0; step < 8; ++step) {
    const double miss_now = miss(now);
    if (std::abs(miss_now) < 0.01) break;
    const double next = now - miss_now * (now - before) / (miss_now - miss_before);
    before = now;
    miss_before = miss_now;
    now = next;
  }
  return graded(now);
}

}  // namespace bespoke
