#include "samples.h"

#include <utility>

#include "accessories.h"
#include "bespoke/error.h"
#include "bespoke/mesh/closest_point.h"
#include "garments.h"
#include "seam_plans.h"
#include "tessellate.h"

namespace bespoke {
namespace {

// By this much (cm) the outline of a mannequin of triangles is shorter than that of its smooth surface.
constexpr double girth_lost_to_chords = 0.2;
Tessellation body_tessellation(double lattice_angle, double coarsest, double deviation = 0.06) {
  Tessellation how;
  how.lattice_spacing = 1.1;
  how.lattice_rotation = oblique_rotation(lattice_angle);
  how.edges = {0.5, coarsest, deviation, 7};
  return how;
}

Tessellation limb_tessellation(double lattice_spacing, double lattice_angle, const RemeshOptions& edges) {
  return {lattice_spacing, oblique_rotation(lattice_angle), edges};
}

// Turned by `turn` about the upright axis, then tilted sideways by `tilt` (degrees), then moved.
Eigen::Isometry3d posed(double turn, double tilt, const Vector3& position) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(position);
  pose.rotate(Eigen::AngleAxisd(tilt * degree, Vector3::UnitZ()));
  pose.rotate(Eigen::AngleAxisd(turn * degree, Vector3::UnitY()));
  return pose;
}

Points moved(const Eigen::Isometry3d& pose, const Points& points) {
  return (pose.linear() * points).colwise() + pose.translation();
}

// Landmarks lie on the implicit surfaces, the triangles' chords a little inside; anchors lie on the
// triangles.
Vector3 onto(const ClosestPointTree& mesh, const Vector3& point) { return mesh.closest(point)->point; }

void add_target(Sample& sample, const std::string& name, const Anatomy& source, const Anatomy& target,
                const Tessellation& how, const Eigen::Isometry3d& world_from_target) {
  SampleTarget made{name, tessellate(target, std::nullopt, how), {}};
  const ClosestPointTree source_tree(sample.source);
  const ClosestPointTree target_tree(made.mesh);
  for (std::size_t i = 0; i < source.landmarks.size(); ++i) {
    const Vector3 on_target = onto(target_tree, target.landmarks[i].point);
    made.anchors.push_back({source.landmarks[i].name, onto(source_tree, source.landmarks[i].point),
                            world_from_target * on_target});
  }
  made.mesh.vertices = moved(world_from_target, made.mesh.vertices);
  sample.targets.push_back(std::move(made));
}

Sample dress_sample() {
  const MannequinBuild slim;
  MannequinBuild full;
  full.height = 172;
  full.shoulders = 1.04;
  full.bust = 1.2;
  full.waist = 1.34;
  full.hips = 1.18;
  full.belly = 2.5;
  full.limbs = 1.15;
  full.breasts = 1.12;
  const Anatomy source = mannequin(slim);
  const Anatomy target = mannequin(full);
  Sample sample{"dress", tessellate(source, std::nullopt, body_tessellation(0, 2.8, 0.09)), {}, {}};
  sample.products = {{"dress", dress(slim, source), dress_seams(slim)}};
  add_target(sample, "", source, target, body_tessellation(40, 3.4, 0.085), posed(35, 4, {120, 3, -30}));
  return sample;
}

Sample girths_sample() {
  const double height = 165;
  const MannequinBuild smallest = graded_build(height, 88 + girth_lost_to_chords);
  const Anatomy source = mannequin(smallest);
  Sample sample{"girths", tessellate(source, std::nullopt, body_tessellation(0, 2.6)), {}, {}};
  sample.products = {{"top", top(smallest, source), top_seams(smallest)},
                     {"skirt", skirt(smallest, source), skirt_seams(smallest)}};
  for (int i = 1; i <= 4; ++i) {
    const int girth = 88 + 6 * i;
    add_target(sample, std::to_string(girth), source,
               mannequin(graded_build(height, girth + girth_lost_to_chords)),
               body_tessellation(11 * i, 2.6 + 0.1 * i), posed(-12.0 * i, 0, {115.0 * i, 0, 0}));
  }
  return sample;
}

Sample glasses_sample() {
  const HeadBuild first;
  const HeadBuild second{1.12, 0.98, 1.14, 0.8, 1.1, 1.12};
  const Anatomy source = display_head(first);
  const Anatomy target = display_head(second);
  Sample sample{"glasses",
                tessellate(source, std::nullopt, limb_tessellation(0.4, 0, {0.3, 1.4, 0.02, 8})),
                {{"frame", glasses_frame(first, source)}, {"lenses", glasses_lenses(first)}},
                {}};
  add_target(sample, "", source, target, limb_tessellation(0.4, 33, {0.3, 1.1, 0.015, 8}),
             posed(-28, -7, {36, 2, -8}));
  return sample;
}

Sample glove_sample() {
  const HandBuild first;
  const HandBuild second{1.02, 1.18, 0.86, 1.15, 1.6};
  const Anatomy source = hand(first);
  const Anatomy target = hand(second);
  Sample sample{"glove",
                tessellate(source, std::nullopt, limb_tessellation(0.21, 0, {0.2, 0.9, 0.014, 8})),
                {{"glove", glove(first, source), glove_seams(source)}},
                {}};
  add_target(sample, "", source, target, limb_tessellation(0.2, 37, {0.2, 0.8, 0.012, 8}),
             posed(40, -18, {24, 1, 5}));
  return sample;
}

Sample shoe_sample() {
  const FootBuild first;
  const FootBuild second{1.1, 1.18, 1.15, 1.12};
  const Anatomy source = foot(first);
  const Anatomy target = foot(second);
  Sample sample{
      "shoe",
      tessellate(source, std::nullopt, limb_tessellation(0.19, 0, {0.2, 1.0, 0.018, 8})),
      {{"upper", shoe_upper(first, source), upper_seams(first)}, {"sole", shoe_sole(first, source)}},
      {}};
  add_target(sample, "", source, target, limb_tessellation(0.2, 35, {0.2, 0.85, 0.014, 8}),
             posed(-24, 5, {22, 1, -4}));
  return sample;
}

using Maker = Sample (*)();

const std::vector<std::pair<std::string, Maker>>& makers() {
  static const std::vector<std::pair<std::string, Maker>> all = {{"dress", dress_sample},
                                                                 {"girths", girths_sample},
                                                                 {"glasses", glasses_sample},
                                                                 {"glove", glove_sample},
                                                                 {"shoe", shoe_sample}};
  return all;
}

}  // namespace

std::vector<std::string> sample_names() {
  std::vector<std::string> names;
  for (const auto& [name, maker] : makers()) names.push_back(name);
  return names;
}

Sample make_sample(const std::string& name) {
  std::string known;
  for (const auto& [each, maker] : makers()) {
    if (each == name) return maker();
    known += (known.empty() ? "" : ", ") + each;
  }
  throw InvalidInput("there is no sample \"" + name + "\"; the samples are " + known);
}

}  // namespace bespoke
