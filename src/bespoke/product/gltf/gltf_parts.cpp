#include <array>
#include <map>
#include <string>

#include "bespoke/product/carry/product_formats.h"
#include "bespoke/product/gltf/scene/gltf_nodes.h"

namespace bespoke {
namespace {

/// Appends columns.
void append(Points& points, const Points& more) {
  const Eigen::Index before = points.cols();
  points.conservativeResize(3, before + more.cols());
  points.rightCols(more.cols()) = more;
}

class PartReader {
 public:
  PartReader(const InputFile& file, ModelPose pose)
      : file_(read_gltf(file)),
        accessors_(read_accessors(file_)),
        scene_(read_scene(file_, accessors_, pose)),
        meshes_(file_.root().elements("meshes")) {}

  PartPoints read(const RigidPart& part) const {
    PartPoints result{part, Points(3, 0), Points(3, 0)};
    const std::vector<bool> is_part = nodes_below(file_, part.name);
    for (const GltfShown& shown : scene_.shown)
      if (is_part[shown.node])
        for (const GltfPart& primitive : meshes_[shown.mesh].elements("primitives"))
          add(primitive, placement(file_, scene_, shown, primitive, accessors_), result);
    if (result.points.cols() == 0) refuse_part(part.name, known(), file_.path);
    return result;
  }

  /// Names of the nodes that show a mesh, by the places of its vertices.
  std::map<std::array<double, 3>, std::string> names_of_places() const {
    const std::vector<GltfPart> nodes = file_.root().elements("nodes");
    std::map<std::array<double, 3>, std::string> names;
    for (const GltfShown& shown : scene_.shown) {
      if (!nodes[shown.node].has("name")) continue;
      PartPoints found{{}, Points(3, 0), Points(3, 0)};
      for (const GltfPart& primitive : meshes_[shown.mesh].elements("primitives"))
        add(primitive, placement(file_, scene_, shown, primitive, accessors_), found);
      for (const auto& x : found.points.colwise())
        names.try_emplace({x[0], x[1], x[2]}, nodes[shown.node].text("name"));
    }
    return names;
  }

 private:
  Points read(std::size_t accessor) const {
    const GltfAccessor& found = accessors_[accessor];
    if (found.components != 3) file_.root().fail_at("accessors", "one is no VEC3, but a mesh's positions");
    return read_values(found, file_.buffers, 0, found.count).cast<double>();
  }

  /// Where the primitive is, and where its morph targets take it.
  void add(const GltfPart& primitive, const GltfPlacement& place, PartPoints& result) const {
    const auto positions = primitive.member("attributes").index("POSITION", accessors_.size());
    if (!positions) return;
    const Points x = read(*positions);
    append(result.points, in_scene(place, x));
    for (const GltfPart& target : primitive.elements("targets")) {
      const auto difference = target.index("POSITION", accessors_.size());
      if (difference && accessors_[*difference].count == accessors_[*positions].count)
        append(result.more, in_scene(place, x + read(*difference)));
    }
  }

  std::string known() const {
    std::vector<std::string> names;
    for (const GltfPart& node : file_.root().elements("nodes"))
      if (node.has("name")) names.push_back(node.text("name"));
    return names.empty() ? "no node has a name" : "its nodes are " + listed(names);
  }

  GltfFile file_;
  std::vector<GltfAccessor> accessors_;
  GltfScene scene_;
  std::vector<GltfPart> meshes_;
};

std::vector<PartPoints> find_parts_in(ModelPose pose, const InputFile& file,
                                      const std::vector<RigidPart>& parts, const Progress& progress) {
  const PartReader reader(file, pose);
  std::vector<PartPoints> result;
  for (const RigidPart& part : parts) {
    progress.check();
    result.push_back(reader.read(part));
  }
  return result;
}

}  // namespace

std::vector<PartPoints> find_gltf_parts(const InputFile& file, const std::vector<RigidPart>& parts,
                                        const Progress& progress) {
  return find_parts_in(ModelPose::shown, file, parts, progress);
}

std::vector<PartPoints> find_stored_gltf_parts(const InputFile& file, const std::vector<RigidPart>& parts,
                                               const Progress& progress) {
  return find_parts_in(ModelPose::stored, file, parts, progress);
}

std::vector<std::string> find_gltf_groups(const InputFile& file, const Points& vertices, ModelPose pose) {
  const std::map<std::array<double, 3>, std::string> names = PartReader(file, pose).names_of_places();
  std::vector<std::string> groups;
  for (const auto& x : vertices.colwise()) {
    const auto at = names.find({x[0], x[1], x[2]});
    groups.push_back(at == names.end() ? std::string() : at->second);
  }
  return groups;
}

}  // namespace bespoke
