#include "bespoke/product/gltf/scene/gltf_bind.h"

#include <algorithm>
#include <set>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/parallel.h"
#include "bespoke/product/gltf/scene/gltf_carrier.h"
#include "bespoke/product/gltf/scene/gltf_frame.h"
#include "bespoke/product/gltf/scene/gltf_target_skin.h"

namespace bespoke {
namespace {

constexpr std::size_t queries_at_a_time = 1024;

/// Everything stays where it is.
PointMotion no_motion() {
  PointMotion motion;
  motion.images = [](const Points& x) { return std::vector<Points>{x}; };
  motion.jacobians = [](const Points& x) {
    return std::vector<Points>{Points(Matrix3::Identity().replicate(1, x.cols()))};
  };
  return motion;
}

class Binder {
 public:
  Binder(const GltfFile& file, const std::vector<GltfAccessor>& accessors, const GltfTargetSkin& skin,
         ModelPose pose)
      : file_(file),
        accessors_(accessors),
        skin_(skin),
        plan_(plan_gltf(file, accessors, pose)),
        frame_(file, accessors, plan_.json) {}

  GltfFrame run() {
    store_as_shown();
    add_skeleton();
    frame_.json()["skins"] = GltfJson::array();
    for (const GltfShown& shown : plan_.scene.shown) bind(shown);
    leave_own_skeleton_out();
    return std::move(frame_);
  }

 private:
  /// What joints held each vertex in a place of its own has that place.
  void store_as_shown() {
    GltfCarriedPlaces places(plan_.places.size());
    for (std::size_t i = 0; i < places.size(); ++i)
      if (!plan_.places[i].of_vertices.empty()) places[i] = AffineMap();
    const PointMotion motion = no_motion();
    const GltfCarrier carrier(file_, accessors_, plan_, motion, {places});
    for (const GltfTask& task : plan_.tasks)
      if (places[task.place]) frame_.store(task, std::move(carrier.carry(task).front().values));
  }

  void add_skeleton() {
    GltfJson& nodes = frame_.json()["nodes"];
    const std::vector<std::size_t> own = skin_.nodes();
    const auto number = [&, first = nodes.size()](std::size_t node) {
      return first + static_cast<std::size_t>(std::lower_bound(own.begin(), own.end(), node) - own.begin());
    };
    for (const std::size_t node : own) {
      const GltfJson& from = skin_.json()["nodes"][node];
      GltfJson copy = GltfJson::object();
      for (const char* key : {"name", "translation", "rotation", "scale", "matrix"})
        if (from.contains(key)) copy[key] = from[key];
      for (const std::size_t child : own)
        if (skin_.hierarchy().parent[child] == node) copy["children"].push_back(number(child));
      nodes.push_back(std::move(copy));
      if (!skin_.hierarchy().parent[node]) add_root(number(node));
    }
    for (const std::size_t joint : skin_.joints()) joints_.push_back(number(joint));
  }

  void add_root(std::size_t node) {
    GltfJson& json = frame_.json();
    if (json.contains("scenes") && !json["scenes"].empty())
      json["scenes"][file_.root().index("scene", json["scenes"].size()).value_or(0)]["nodes"].push_back(node);
  }

  /// The transform of a skinned mesh's node counts for nothing, and should not be there.
  void bind(const GltfShown& shown) {
    GltfJson& json = frame_.json();
    const AffineMap scene_from_mesh = shown.pose ? AffineMap() : shown.scene_from_mesh;
    const std::size_t skin = skin_for(scene_from_mesh);
    const std::size_t mesh = json["nodes"][shown.node]["mesh"].get<std::size_t>();
    if (bound_.insert(mesh).second) give_weights(shown, mesh);
    const bool is_free =
        !plan_.scene.nodes.parent[shown.node] && is_same(plan_.scene.nodes.local[shown.node], AffineMap());
    if (is_free) {
      json["nodes"][shown.node]["skin"] = skin;
      return;
    }
    GltfJson moved = GltfJson::object();
    for (const char* key : {"name", "mesh", "weights"})
      if (GltfJson& node = json["nodes"][shown.node]; node.contains(key)) moved[key] = node[key];
    for (const char* key : {"mesh", "skin", "weights"}) json["nodes"][shown.node].erase(key);
    moved["skin"] = skin;
    json["nodes"].push_back(std::move(moved));
    add_root(json["nodes"].size() - 1);
  }

  std::size_t skin_for(const AffineMap& scene_from_mesh) {
    for (std::size_t i = 0; i < skins_.size(); ++i)
      if (is_same(skins_[i], scene_from_mesh)) return i;
    GltfValues matrices(16, static_cast<Eigen::Index>(joints_.size()));
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      const AffineMap bind = composed(inverse_of(skin_.scene_from_joint()[i]), scene_from_mesh);
      Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
      matrix.topLeftCorner<3, 3>() = bind.linear;
      matrix.topRightCorner<3, 1>() = bind.offset;
      matrices.col(static_cast<Eigen::Index>(i)) = matrix.cast<float>().reshaped();
    }
    const std::size_t accessor = frame_.add("MAT4", GltfComponent::real, {}, std::move(matrices));
    frame_.json()["skins"].push_back({{"joints", joints_}, {"inverseBindMatrices", accessor}});
    skins_.push_back(scene_from_mesh);
    return skins_.size() - 1;
  }

  void give_weights(const GltfShown& shown, std::size_t mesh) {
    const std::vector<GltfPart> primitives =
        file_.root().elements("meshes")[shown.mesh].elements("primitives");
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      const auto positions = primitives[p].member("attributes").index("POSITION", accessors_.size());
      if (!positions) continue;
      const GltfPlacement place = placement(file_, plan_.scene, shown, primitives[p], accessors_);
      const GltfAccessor& vertices = accessors_[*positions];
      const Points x =
          in_scene(place, read_values(vertices, file_.buffers, 0, vertices.count).cast<double>());
      GltfValues joints(4, x.cols()), weights(4, x.cols());
      parallel_for(vertices.count, queries_at_a_time, [&](std::size_t begin, std::size_t end) {
        for (auto i = static_cast<Eigen::Index>(begin); i < static_cast<Eigen::Index>(end); ++i) {
          const GltfPointWeights found = skin_.weights_at(x.col(i));
          for (std::size_t k = 0; k < 4; ++k) {
            joints(static_cast<Eigen::Index>(k), i) = static_cast<float>(found.joints[k]);
            weights(static_cast<Eigen::Index>(k), i) = static_cast<float>(found.weights[k]);
          }
        }
      });
      GltfJson& attributes = frame_.json()["meshes"][mesh]["primitives"][p]["attributes"];
      for (const std::string& name : primitives[p].member("attributes").names())
        if (name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_")) attributes.erase(name);
      const std::size_t joint_accessor =
          frame_.add("VEC4", GltfComponent::uint16, GltfTarget::vertices, std::move(joints));
      const std::size_t weight_accessor =
          frame_.add("VEC4", GltfComponent::real, GltfTarget::vertices, std::move(weights));
      frame_.json()["meshes"][mesh]["primitives"][p]["attributes"]["JOINTS_0"] = joint_accessor;
      frame_.json()["meshes"][mesh]["primitives"][p]["attributes"]["WEIGHTS_0"] = weight_accessor;
    }
  }

  /// Trees of the scene that hold joints and show nothing any longer, and what moves only them.
  void leave_own_skeleton_out() {
    GltfJson& json = frame_.json();
    const GltfScene& scene = plan_.scene;
    std::vector<std::size_t> root(scene.nodes.parent.size());
    std::set<std::size_t> rigged, showing;
    for (const std::size_t node : scene.nodes.order) {
      root[node] = scene.nodes.parent[node] ? root[*scene.nodes.parent[node]] : node;
      if (scene.is_rigged[node]) rigged.insert(root[node]);
      for (const char* key : {"mesh", "camera", "extensions"})
        if (json["nodes"][node].contains(key)) showing.insert(root[node]);
    }
    const auto is_left_out = [&](const GltfJson& node) {
      const auto number = node.get<std::size_t>();
      return number < root.size() && rigged.contains(root[number]) && !showing.contains(root[number]);
    };
    const auto erase_where = [](GltfJson& array, const auto& is_erased) {
      array.erase(std::remove_if(array.begin(), array.end(), is_erased), array.end());
    };
    if (json.contains("scenes"))
      for (GltfJson& own : json["scenes"])
        if (own.contains("nodes")) erase_where(own["nodes"], is_left_out);
    if (!json.contains("animations")) return;
    erase_where(json["animations"], [&](const GltfJson& animation) {
      return std::all_of(
          animation["channels"].begin(), animation["channels"].end(), [&](const auto& channel) {
            return channel["target"].contains("node") && is_left_out(channel["target"]["node"]);
          });
    });
    if (json["animations"].empty()) json.erase("animations");
  }

  const GltfFile& file_;
  const std::vector<GltfAccessor>& accessors_;
  const GltfTargetSkin& skin_;
  const GltfPlan plan_;
  GltfFrame frame_;
  std::vector<std::size_t> joints_;  ///< in the result
  std::vector<AffineMap> skins_;     ///< of the result: where it takes meshes
  std::set<std::size_t> bound_;      ///< meshes of the result that have their weights
};

}  // namespace

std::size_t bind_gltf(const InputFile& product, const InputFile& target, ModelPose pose, OutputFile& output) {
  const GltfTargetSkin skin(target);
  const GltfFile file = read_gltf(product);
  if (!file.has_binary_chunk() || file.buffers.size() != 1)
    throw InvalidInput(product.path().string() +
                       ": binding it to a skeleton needs a .glb with all buffers inside; pack it into one");
  const std::vector<GltfAccessor> accessors = read_accessors(file);
  GltfFrame frame = Binder(file, accessors, skin, pose).run();
  write_gltf(file, frame.text(), frame.buffers().front(), output);
  return skin.joints().size();
}

}  // namespace bespoke
