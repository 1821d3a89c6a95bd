#include "bespoke/product/detail/gltf_plan.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

namespace bespoke {
namespace {

std::string at(const char* array, std::size_t index) {
  return "/" + std::string(array) + "/" + std::to_string(index);
}

/// The index under a key into an array of the top level; none without the key.
std::optional<std::size_t> reference(const GltfModel& model, const GltfJson& object, const char* key,
                                     const std::string& pointer, std::size_t count) {
  const auto found = object.find(key);
  if (found == object.end()) return std::nullopt;
  if (!found->is_number_unsigned() || found->get<std::uint64_t>() >= count)
    model.fail(pointer + "/" + key, "names nothing that is there");
  return found->get<std::size_t>();
}

std::size_t size_of(const GltfJson& json, const char* key) {
  return json.contains(key) ? json[key].size() : 0;
}

Eigen::VectorXd numbers(const GltfModel& model, const GltfJson& node, const char* key,
                        Eigen::VectorXd otherwise, const std::string& pointer) {
  const auto found = node.find(key);
  if (found == node.end()) return otherwise;
  const auto size = static_cast<std::size_t>(otherwise.size());
  if (!found->is_array() || found->size() != size)
    model.fail(pointer + "/" + key, "are not " + std::to_string(size) + " numbers");
  for (std::size_t i = 0; i < size; ++i) {
    if (!(*found)[i].is_number())
      model.fail(pointer + "/" + key, "are not " + std::to_string(size) + " numbers");
    otherwise[static_cast<Eigen::Index>(i)] = (*found)[i].get<double>();
  }
  return otherwise;
}

AffineMap local_transform(const GltfModel& model, const GltfJson& node, const std::string& pointer) {
  AffineMap map;
  if (node.contains("matrix")) {
    const Eigen::VectorXd m = numbers(model, node, "matrix", Eigen::VectorXd::Zero(16), pointer);
    const Eigen::Matrix4d matrix = Eigen::Map<const Eigen::Matrix4d>(m.data());
    map.linear = matrix.topLeftCorner<3, 3>();
    map.offset = matrix.topRightCorner<3, 1>();
    return map;
  }
  const Eigen::VectorXd q =
      numbers(model, node, "rotation", (Eigen::VectorXd(4) << 0, 0, 0, 1).finished(), pointer);
  const Eigen::VectorXd s = numbers(model, node, "scale", Eigen::VectorXd::Ones(3), pointer);
  const bool is_turned = q[0] != 0 || q[1] != 0 || q[2] != 0;
  if (is_turned) map.linear = Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized().toRotationMatrix();
  map.linear = (map.linear * s.asDiagonal()).eval();
  map.offset = numbers(model, node, "translation", Eigen::VectorXd::Zero(3), pointer);
  return map;
}

/// From every node into the scene.
std::vector<AffineMap> scene_transforms(const GltfModel& model) {
  const std::size_t count = size_of(model.json, "nodes");
  std::vector<AffineMap> local;
  std::vector<std::optional<std::size_t>> parent(count);
  for (std::size_t i = 0; i < count; ++i) {
    const GltfJson& node = model.json["nodes"][i];
    local.push_back(local_transform(model, node, at("nodes", i)));
    if (!node.contains("children")) continue;
    for (const GltfJson& child : node["children"]) {
      if (!child.is_number_unsigned() || child.get<std::uint64_t>() >= count)
        model.fail(at("nodes", i) + "/children", "name a node that is not there");
      if (parent[child.get<std::size_t>()])
        model.fail(at("nodes", child.get<std::size_t>()), "has two parents");
      parent[child.get<std::size_t>()] = i;
    }
  }
  std::vector<AffineMap> world;
  for (std::size_t i = 0; i < count; ++i) {
    AffineMap map = local[i];
    std::size_t steps = 0;
    for (std::optional<std::size_t> up = parent[i]; up; up = parent[*up]) {
      if (++steps > count) model.fail(at("nodes", i), "is its own ancestor");
      map.offset = local[*up] * map.offset;
      map.linear = (local[*up].linear * map.linear).eval();
    }
    const double determinant = map.linear.determinant();
    if (model.json["nodes"][i].contains("mesh") && !(std::abs(determinant) > 0 && std::isfinite(determinant)))
      model.fail(at("nodes", i), "its transform cannot be undone");
    world.push_back(map);
  }
  return world;
}

class Planner {
 public:
  explicit Planner(const GltfModel& model) : model_(model) { plan_.json = model.json; }

  GltfPlan run() {
    const std::vector<AffineMap> world = scene_transforms(model_);
    const std::size_t meshes = size_of(model_.json, "meshes");
    std::vector<std::vector<std::pair<std::size_t, std::size_t>>> shown(meshes);  // (transform, mesh)
    bool is_skinned = false;
    for (std::size_t i = 0; i < world.size(); ++i) {
      const GltfJson& node = model_.json["nodes"][i];
      const auto mesh = reference(model_, node, "mesh", at("nodes", i), meshes);
      if (!mesh) continue;
      // A skin's joints place its mesh, the node does not; in the bind pose they leave it where it is.
      is_skinned = is_skinned || node.contains("skin");
      const std::size_t transform = transform_index(node.contains("skin") ? AffineMap() : world[i]);
      auto& places = shown[*mesh];
      auto place =
          std::find_if(places.begin(), places.end(), [&](const auto& p) { return p.first == transform; });
      if (place == places.end()) {
        places.emplace_back(transform, places.empty() ? *mesh : copy_of_mesh(*mesh));
        place = places.end() - 1;
      }
      if (place->second != *mesh) plan_.json["nodes"][i]["mesh"] = place->second;
    }
    std::size_t hidden = 0;
    for (std::size_t mesh = 0; mesh < meshes; ++mesh) {
      hidden += shown[mesh].empty();
      for (const auto& [transform, place] : shown[mesh]) plan_mesh(mesh, place, transform);
    }
    if (is_skinned) warn("a skinned mesh was carried in its bind pose; its skin was left as it is");
    if (hidden > 0) warn(std::to_string(hidden) + " meshes that no node shows were left as they are");
    if (size_of(model_.json, "animations") > 0) warn("animations were left as they are");
    return std::move(plan_);
  }

 private:
  void warn(std::string text) { plan_.warnings.push_back(std::move(text)); }

  std::size_t transform_index(const AffineMap& map) {
    for (std::size_t i = 0; i < plan_.transforms.size(); ++i)
      if (plan_.transforms[i].linear == map.linear && plan_.transforms[i].offset == map.offset) return i;
    plan_.transforms.push_back(map);
    return plan_.transforms.size() - 1;
  }

  std::size_t copy_of_mesh(std::size_t mesh) {
    GltfJson copy = model_.json["meshes"][mesh];
    plan_.json["meshes"].push_back(std::move(copy));
    return plan_.json["meshes"].size() - 1;
  }

  void plan_mesh(std::size_t mesh, std::size_t result, std::size_t transform) {
    const GltfJson& primitives = model_.json["meshes"][mesh].contains("primitives")
                                     ? model_.json["meshes"][mesh]["primitives"]
                                     : GltfJson::array();
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      const std::string pointer = at("meshes", mesh) + "/primitives/" + std::to_string(p);
      if (!primitives[p].is_object() || !primitives[p].contains("attributes"))
        model_.fail(pointer, "has no attributes");
      reference(model_, primitives[p], "indices", pointer, model_.accessors.size());
      const GltfJson& attributes = primitives[p]["attributes"];
      const auto positions = accessor(attributes, "POSITION", pointer + "/attributes", 3);
      if (!positions) continue;
      GltfJson& target = plan_.json["meshes"][result]["primitives"][p];
      std::map<std::string, std::size_t> bases;
      for (const auto& [name, role, components] : roles) {
        const auto base = accessor(attributes, name, pointer + "/attributes", components);
        if (!base) continue;
        require_same_count(*base, *positions);
        bases[name] = *base;
        assign({role, *positions, *base, {}, {}, transform, 0}, target["attributes"][name]);
      }
      if (!primitives[p].contains("targets")) continue;
      for (std::size_t t = 0; t < primitives[p]["targets"].size(); ++t) {
        const GltfJson& morph = primitives[p]["targets"][t];
        const std::string morph_pointer = pointer + "/targets/" + std::to_string(t);
        const auto moved = accessor(morph, "POSITION", morph_pointer, 3);
        for (const auto& [name, role, components] : roles) {
          const auto difference = accessor(morph, name, morph_pointer, 3);
          if (!difference) continue;
          if (!bases.contains(name)) model_.fail(morph_pointer + "/" + name, "has no base in the primitive");
          require_same_count(*difference, *positions);
          assign({role, *positions, bases[name], difference, moved, transform, 0},
                 target["targets"][t][name]);
        }
      }
    }
  }

  std::optional<std::size_t> accessor(const GltfJson& attributes, const char* name,
                                      const std::string& pointer, int components) const {
    const auto index = reference(model_, attributes, name, pointer, model_.accessors.size());
    if (index && model_.accessors[*index].components != components)
      model_.fail(at("accessors", *index) + "/type", std::string("does not fit ") + name);
    return index;
  }

  void require_same_count(std::size_t index, std::size_t positions) const {
    if (model_.accessors[index].count != model_.accessors[positions].count)
      model_.fail(at("accessors", index) + "/count", "is not that of the primitive's positions");
  }

  // What an accessor becomes depends on all that the key names: the first such use stays in its place, any
  // other gets an accessor of its own.
  void assign(GltfTask task, GltfJson& slot) {
    const auto none = model_.accessors.size();
    const Key key{task.source(),  task.transform, static_cast<int>(task.role),
                  task.positions, task.base,      task.difference_of_positions.value_or(none)};
    auto known = results_.find(key);
    if (known == results_.end()) {
      const bool is_first = !taken_.contains(task.source());
      taken_.insert(task.source());
      task.result = is_first ? task.source() : copy_of_accessor(task.source());
      known = results_.emplace(key, task.result).first;
      plan_.tasks.push_back(task);
    }
    if (slot != known->second) slot = known->second;
  }

  std::size_t copy_of_accessor(std::size_t index) {
    GltfJson copy = model_.json["accessors"][index];
    plan_.json["accessors"].push_back(std::move(copy));
    return plan_.json["accessors"].size() - 1;
  }

  struct Role {
    const char* name;
    GltfRole role;
    int components;
  };
  static constexpr std::array<Role, 3> roles{{{"POSITION", GltfRole::position, 3},
                                              {"NORMAL", GltfRole::normal, 3},
                                              {"TANGENT", GltfRole::tangent, 4}}};
  using Key = std::tuple<std::size_t, std::size_t, int, std::size_t, std::size_t, std::size_t>;

  const GltfModel& model_;
  GltfPlan plan_;
  std::map<Key, std::size_t> results_;
  std::set<std::size_t> taken_;
};

}  // namespace

GltfPlan plan_gltf(const GltfModel& model) { return Planner(model).run(); }

}  // namespace bespoke
