#include "seam_plans.h"

#include <algorithm>
#include <cmath>

namespace bespoke {
namespace {

// Of the mannequin's standard height: where side and shoulder seams run, just behind the middle (cm).
constexpr double frontal_plane = -0.8;

/// In the standard mannequin's coordinates.
Field standard(const MannequinBuild& build, const Field& field) {
  const double scale = build.height / standard_height;
  return [scale, field](const Vector3& p) { return field(p / scale); };
}

SeamLevel side_seams(const MannequinBuild& build) {
  return {"side", standard(build, [](const Vector3& p) { return p.z() - frontal_plane; })};
}

/// Straight between (height, half width) pairs, the highest first.
Field panel_seams(const std::vector<std::pair<double, double>>& course) {
  return [course](const Vector3& p) {
    double half = course.back().second;
    if (p.y() > course.front().first) half = course.front().second;
    for (std::size_t k = 0; k + 1 < course.size(); ++k) {
      const auto& [above, there] = course[k];
      const auto& [below, here] = course[k + 1];
      if (p.y() > above || p.y() < below) continue;
      half = here + (there - here) * (p.y() - below) / (above - below);
    }
    return std::abs(p.x()) - half;
  };
}

std::vector<SeamPoint> scaled_points(const MannequinBuild& build, std::vector<SeamPoint> points) {
  for (SeamPoint& point : points) point.near *= build.height / standard_height;
  return points;
}

}  // namespace

SeamPlan dress_seams(const MannequinBuild& build) {
  SeamPlan plan;
  plan.seams = {
      side_seams(build),
      {"panel", standard(build, panel_seams({{137, 10.6}, {118, 7.2}, {102, 4.6}, {88, 6.5}, {50, 11}}))},
      {"waist", standard(build, [](const Vector3& p) { return p.y() - 102; })}};
  plan.pieces = scaled_points(build, {{"bodice front", {0, 115, 12}},
                                      {"bodice back", {0, 115, -11}},
                                      {"bodice front left", {11, 113, 6}},
                                      {"bodice front right", {-11, 113, 6}},
                                      {"bodice back left", {11, 113, -6}},
                                      {"bodice back right", {-11, 113, -6}},
                                      {"skirt front", {0, 70, 23}},
                                      {"skirt back", {0, 70, -23}},
                                      {"skirt front left", {20, 70, 12}},
                                      {"skirt front right", {-20, 70, 12}},
                                      {"skirt back left", {20, 70, -12}},
                                      {"skirt back right", {-20, 70, -12}}});
  plan.widths = scaled_points(build, {{"bust", {0, 118, 13}}, {"hip", {0, 84, 14}}});
  return plan;
}

SeamPlan top_seams(const MannequinBuild& build) {
  SeamPlan plan;
  const double shoulder = 14.2 * build.shoulders;
  plan.seams = {side_seams(build),
                {"armhole", standard(build,
                                     [shoulder](const Vector3& p) {
                                       return std::abs(p.x()) - shoulder - 0.16 * (131 - p.y());
                                     })},
                {"panel", standard(build, panel_seams({{137, 10.6}, {118, 7.2}, {102, 6.5}, {95, 7}}))}};
  plan.pieces = scaled_points(build, {{"front", {0, 110, 12}},
                                      {"back", {0, 110, -11}},
                                      {"front left", {11, 108, 7}},
                                      {"front right", {-11, 108, 7}},
                                      {"back left", {11, 108, -7}},
                                      {"back right", {-11, 108, -7}},
                                      {"sleeve front left", {22, 126, 5}},
                                      {"sleeve front right", {-22, 126, 5}},
                                      {"sleeve back left", {22, 126, -7}},
                                      {"sleeve back right", {-22, 126, -7}}});
  plan.widths = scaled_points(build, {{"bust", {0, 118, 13}}});
  return plan;
}

SeamPlan skirt_seams(const MannequinBuild& build) {
  SeamPlan plan;
  plan.seams = {side_seams(build), {"gore", standard(build, panel_seams({{103, 4.2}, {88, 6.5}, {53, 9}}))}};
  plan.pieces = scaled_points(build, {{"front", {0, 70, 18}},
                                      {"back", {0, 70, -18}},
                                      {"front left", {15, 70, 10}},
                                      {"front right", {-15, 70, 10}},
                                      {"back left", {15, 70, -10}},
                                      {"back right", {-15, 70, -10}}});
  plan.widths = scaled_points(build, {{"hip", {0, 84, 13}}, {"hem", {0, 55, 18}}});
  return plan;
}

SeamPlan glove_seams(const Anatomy& hand) {
  // Points in the middle of the hand's thickness; between them the nearest count.
  std::vector<Vector3> middles;
  for (const Landmark& front : hand.landmarks) {
    const auto ending = front.name.rfind("_front");
    if (front.name.ends_with("_tip") || front.name.ends_with("_side")) middles.push_back(front.point);
    if (ending == std::string::npos) continue;
    for (const Landmark& back : hand.landmarks)
      if (back.name == front.name.substr(0, ending) + "_back")
        middles.push_back((front.point + back.point) / 2);
  }
  const Field middle = [middles](const Vector3& p) {
    double sum = 0, weights = 0;
    for (const Vector3& m : middles) {
      const double squared = (p - m).head<2>().squaredNorm() + 0.01;  // cm²
      const double weight = 1 / (squared * squared);
      sum += weight * m.z();
      weights += weight;
    }
    return p.z() - sum / weights;
  };
  SeamPlan plan;
  plan.seams = {{"edge", middle}, {"cuff", [](const Vector3& p) { return p.y() + 3.5; }}};
  plan.pieces = {
      {"palm", {0, 5, 2}}, {"back", {0, 5, -2}}, {"cuff palm", {0, -5, 3}}, {"cuff back", {0, -5, -3}}};
  plan.widths = {{"knuckles", {0, 8.5, 2}}};
  return plan;
}

SeamPlan upper_seams(const FootBuild& build) {
  constexpr double feather = 0.35;  // cm above the sole, where the lasted margin turns under
  const auto flat_height = [build](const Vector3& p) { return p.y() - heel_lift(build, p.z()); };
  const double l = build.length;
  const Field above = [flat_height](const Vector3& p) { return flat_height(p) - feather; };
  SeamPlan plan;
  plan.seams = {{"feather", above},
                {"back", [](const Vector3& p) { return p.x(); },
                 [above](const Vector3& p) { return std::min(above(p), -p.z()); }},
                {"vamp", [l](const Vector3& p) { return p.z() - 8.2 * l; }, above},
                {"toe cap", [l](const Vector3& p) { return p.z() - 13.8 * l; }, above}};
  plan.pieces = {{"insole", {0, -0.2, 11.5}},
                 {"toe cap", {0, 2.2, 16}},
                 {"vamp", {0, 3.4, 11.8}},
                 {"quarter left", {4, 2, 2}},
                 {"quarter right", {-4, 2, 2}}};
  return plan;
}

}  // namespace bespoke
