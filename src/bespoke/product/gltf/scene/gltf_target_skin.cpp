#include "bespoke/product/gltf/scene/gltf_target_skin.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/product/gltf/scene/gltf_triangles.h"

namespace bespoke {

GltfTargetSkin::GltfTargetSkin(const InputFile& file)
    : file_(read_gltf(file)), accessors_(read_accessors(file_)), scene_(read_scene(file_, accessors_)) {
  read_joints();
  read_surface();
}

void GltfTargetSkin::read_joints() {
  for (const auto& [skin, pose] : scene_.poses)
    joints_.insert(joints_.end(), pose.joints.begin(), pose.joints.end());
  std::sort(joints_.begin(), joints_.end());
  joints_.erase(std::unique(joints_.begin(), joints_.end()), joints_.end());
  const std::vector<GltfPart> nodes = file_.root().elements("nodes");
  for (const std::size_t joint : joints_) {
    scene_from_joint_.push_back(scene_.scene_from_node[joint]);
    if (!is_invertible(scene_from_joint_.back())) nodes[joint].fail("is a joint without extent");
  }
}

void GltfTargetSkin::read_surface() {
  const std::vector<GltfPart> meshes = file_.root().elements("meshes");
  std::vector<Points> places;
  Eigen::Index count = 0;
  for (GltfTriangles& triangles : shown_triangles(file_, accessors_, scene_)) {
    const GltfShown& shown = scene_.shown[triangles.shown];
    if (!shown.skin) continue;
    const GltfPart primitive = meshes[shown.mesh].elements("primitives")[triangles.primitive];
    const std::vector<std::size_t>& joints = scene_.poses.at(*shown.skin).joints;
    Source source{read_weights(file_, primitive, joints.size(), accessors_), {}};
    for (const std::size_t joint : joints)
      source.joints.push_back(static_cast<std::size_t>(
          std::lower_bound(joints_.begin(), joints_.end(), joint) - joints_.begin()));
    for (const std::uint32_t vertex : triangles.corners) corners_.push_back({sources_.size(), vertex});
    sources_.push_back(std::move(source));
    count += triangles.places.cols();
    places.push_back(std::move(triangles.places));
  }
  if (count == 0)
    throw InvalidInput(
        file_.path.string() +
        ": shows no skinned mesh, so there is no skeleton to bind to; name a model that has one");
  TriangleMesh surface;
  surface.vertices.resize(3, count);
  Eigen::Index at = 0;
  for (const Points& own : places) {
    surface.vertices.middleCols(at, own.cols()) = own;
    at += own.cols();
  }
  surface.faces.resize(3, count / 3);
  std::iota(surface.faces.data(), surface.faces.data() + count, 0);
  tree_.emplace(surface);
}

std::vector<std::size_t> GltfTargetSkin::nodes() const {
  std::vector<bool> is_needed(scene_.nodes.parent.size());
  for (const std::size_t joint : joints_)
    for (std::optional<std::size_t> node = joint; node && !is_needed[*node];
         node = scene_.nodes.parent[*node])
      is_needed[*node] = true;
  std::vector<std::size_t> result;
  for (std::size_t node = 0; node < is_needed.size(); ++node)
    if (is_needed[node]) result.push_back(node);
  return result;
}

GltfPointWeights GltfTargetSkin::weights_at(const Vector3& x) const {
  const SurfacePoint nearest = tree_->closest(x).value();
  std::map<std::size_t, double> by_joint;
  for (int k = 0; k < 3; ++k) {
    const Corner& corner = corners_[static_cast<std::size_t>(3 * nearest.face + k)];
    const Source& source = sources_[corner.source];
    const std::size_t begin = source.weights.start[corner.vertex];
    const std::size_t end = source.weights.start[corner.vertex + 1];
    double total = 0;
    for (std::size_t i = begin; i < end; ++i) total += source.weights.weights[i].weight;
    for (std::size_t i = begin; i < end; ++i)
      by_joint[source.joints[source.weights.weights[i].joint]] +=
          nearest.barycentric[k] * source.weights.weights[i].weight / total;
  }
  std::vector<std::pair<std::size_t, double>> largest(by_joint.begin(), by_joint.end());
  std::stable_sort(largest.begin(), largest.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  GltfPointWeights result;
  largest.resize(std::min(largest.size(), result.joints.size()));
  double kept = 0;
  for (const auto& [joint, weight] : largest) kept += weight;
  for (std::size_t i = 0; i < largest.size() && largest[i].second > 0; ++i) {
    result.joints[i] = largest[i].first;
    result.weights[i] = largest[i].second / kept;
  }
  return result;
}

}  // namespace bespoke
