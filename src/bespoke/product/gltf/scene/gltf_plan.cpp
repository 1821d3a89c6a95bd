#include "bespoke/product/gltf/scene/gltf_plan.h"

#include <algorithm>
#include <array>
#include <map>
#include <tuple>
#include <utility>

#include "bespoke/product/gltf/document/gltf_extensions.h"

namespace bespoke {
namespace {

struct RoleOfAttribute {
  const char* name;
  GltfRole role;
  const char* type;
};
constexpr std::array<RoleOfAttribute, 3> roles{{{"POSITION", GltfRole::position, "VEC3"},
                                                {"NORMAL", GltfRole::normal, "VEC3"},
                                                {"TANGENT", GltfRole::tangent, "VEC4"}}};

class Planner {
 public:
  Planner(const GltfFile& file, const std::vector<GltfAccessor>& accessors)
      : file_(file), accessors_(accessors), stays_(shares_bytes(accessors)) {
    plan_.json = file.json;
  }

  GltfPlan run(ModelPose pose) {
    scene_ = read_scene(file_, accessors_, pose);
    const std::vector<GltfPart> meshes = file_.root().elements("meshes");
    if (scene_.posed > 0)
      plan_.warnings.emplace_back(
          "a skinned mesh was carried in the pose in which its nodes show it, which is not the one in which "
          "it is stored");
    std::vector<std::vector<std::pair<const GltfShown*, std::size_t>>> shown(meshes.size());  // and the mesh
    for (const GltfShown& item : scene_.shown) {
      auto& own = shown[item.mesh];
      auto found =
          std::find_if(own.begin(), own.end(), [&](const auto& pair) { return is_same(*pair.first, item); });
      if (found == own.end()) {
        own.emplace_back(&item, own.empty() ? item.mesh : copy("meshes", item.mesh));
        found = own.end() - 1;
      }
      if (found->second != item.mesh) plan_.json["nodes"][item.node]["mesh"] = found->second;
    }
    std::size_t hidden = 0;
    for (std::size_t mesh = 0; mesh < meshes.size(); ++mesh) {
      keep_other_uses(meshes[mesh], shown[mesh].empty());
      hidden += shown[mesh].empty();
    }
    for (std::size_t mesh = 0; mesh < meshes.size(); ++mesh)
      for (const auto& [item, result] : shown[mesh]) plan_mesh(meshes[mesh], result, *item);
    if (hidden > 0)
      plan_.warnings.push_back("meshes that no node shows were left as they are: " + std::to_string(hidden));
    plan_.scene = std::move(scene_);
    return std::move(plan_);
  }

 private:
  static bool is_same(const GltfShown& a, const GltfShown& b) {
    return a.pose == b.pose && a.holder == b.holder && bespoke::is_same(a.scene_from_mesh, b.scene_from_mesh);
  }

  /// Of the places of what the node shows: of a mesh in a pose they depend on the vertices' joints too.
  std::size_t place_index(const GltfShown& shown, const GltfPart& primitive) {
    std::vector<std::size_t> held;
    if (shown.pose)
      for (const std::string& name : primitive.member("attributes").names())
        if (name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_"))
          held.push_back(*primitive.member("attributes").index(name.c_str(), accessors_.size()));
    for (std::size_t i = 0; i < placed_.size(); ++i)
      if (is_same(*placed_[i].first, shown) && placed_[i].second == held) return i;
    GltfPlacement place = placement(file_, scene_, shown, primitive, accessors_);
    for (std::size_t vertex = 0; vertex < place.of_vertices.size(); ++vertex)
      if (!is_invertible(place.of_vertices[vertex]))
        primitive.fail("its joints hold vertex " + std::to_string(vertex) + " flat, which cannot be undone");
    plan_.places.push_back(std::move(place));
    placed_.emplace_back(&shown, std::move(held));
    return plan_.places.size() - 1;
  }

  std::size_t copy(const char* array, std::size_t index) {
    GltfJson element = file_.json[array][index];
    plan_.json[array].push_back(std::move(element));
    return plan_.json[array].size() - 1;
  }

  /// Values that something refers to which is not carried stay where they are.
  void keep_other_uses(const GltfPart& mesh, bool is_hidden) {
    for (const GltfPart& primitive : mesh.elements("primitives")) {
      std::vector<GltfPart> lists = primitive.elements("targets");
      lists.push_back(primitive.member("attributes"));
      for (const GltfPart& list : lists)
        for (const std::string& name : list.names()) {
          const auto index = list.index(name.c_str(), accessors_.size());
          const bool has_role =
              std::any_of(roles.begin(), roles.end(), [&](const auto& role) { return name == role.name; });
          if (is_hidden || !has_role) stays_[*index] = true;
        }
    }
  }

  void plan_mesh(const GltfPart& mesh, std::size_t result, const GltfShown& shown) {
    const std::vector<GltfPart> primitives = mesh.elements("primitives");
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      require_not_compressed(primitives[p]);
      primitives[p].index("indices", accessors_.size());
      plan_primitive(primitives[p], plan_.json["meshes"][result]["primitives"][p], shown);
    }
  }

  void plan_primitive(const GltfPart& primitive, GltfJson& result, const GltfShown& shown) {
    const GltfPart attributes = primitive.member("attributes");
    const auto positions = accessor(attributes, "POSITION", "VEC3");
    if (!positions) return;
    const std::size_t place = place_index(shown, primitive);
    std::map<std::string, std::size_t> bases;
    for (const auto& [name, role, type] : roles) {
      const auto base = accessor(attributes, name, type);
      if (!base) continue;
      require_same_count(attributes, name, *base, *positions);
      bases[name] = *base;
      assign({role, *positions, *base, {}, {}, place, 0}, result["attributes"][name]);
    }
    const std::vector<GltfPart> targets = primitive.elements("targets");
    for (std::size_t t = 0; t < targets.size(); ++t) {
      const auto shift = accessor(targets[t], "POSITION", "VEC3");
      if (shift) require_same_count(targets[t], "POSITION", *shift, *positions);
      for (const auto& [name, role, type] : roles) {
        const auto difference = accessor(targets[t], name, "VEC3");
        if (!difference) continue;
        if (!bases.contains(name)) targets[t].fail_at(name, "has no such attribute to differ from");
        require_same_count(targets[t], name, *difference, *positions);
        assign({role, *positions, bases[name], difference, shift, place, 0}, result["targets"][t][name]);
      }
    }
  }

  std::optional<std::size_t> accessor(const GltfPart& list, const char* name, const char* type) const {
    const auto index = list.index(name, accessors_.size());
    if (!index) return index;
    const GltfAccessor& found = accessors_[*index];
    if (found.type != type || found.component == GltfComponent::uint32)
      list.fail_at(name, "must be " + std::string(type) + " of floats or of 8 or 16 bits, which " +
                             found.pointer + " is not");
    return index;
  }

  void require_same_count(const GltfPart& list, const char* name, std::size_t index,
                          std::size_t positions) const {
    if (accessors_[index].count != accessors_[positions].count)
      list.fail_at(name, "has " + std::to_string(accessors_[index].count) + " values, but there are " +
                             std::to_string(accessors_[positions].count) + " positions");
  }

  // What an accessor becomes depends on all that the key names: the first such use stays in its place, any
  // other gets an accessor of its own.
  void assign(GltfTask task, GltfJson& slot) {
    const std::size_t none = accessors_.size();
    const Key key{task.source(),  task.place, task.role,
                  task.positions, task.base,  task.difference_of_positions.value_or(none)};
    auto known = results_.find(key);
    if (known == results_.end()) {
      task.result = stays_[task.source()] ? copy("accessors", task.source()) : task.source();
      stays_[task.source()] = true;
      known = results_.emplace(key, task.result).first;
      plan_.tasks.push_back(task);
    }
    if (slot != known->second) slot = known->second;
  }

  using Key = std::tuple<std::size_t, std::size_t, GltfRole, std::size_t, std::size_t, std::size_t>;

  const GltfFile& file_;
  const std::vector<GltfAccessor>& accessors_;
  std::vector<bool> stays_;  ///< of every accessor: its values must not change where they are
  GltfScene scene_;
  GltfPlan plan_;
  std::vector<std::pair<const GltfShown*, std::vector<std::size_t>>> placed_;  ///< of every place of the plan
  std::map<Key, std::size_t> results_;
};

}  // namespace

GltfPlan plan_gltf(const GltfFile& file, const std::vector<GltfAccessor>& accessors, ModelPose pose) {
  return Planner(file, accessors).run(pose);
}

}  // namespace bespoke
