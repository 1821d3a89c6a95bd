#include "bespoke/product/faces/face_group_formats.h"
#include "bespoke/product/faces/gathered_faces.h"
#include "bespoke/product/gltf/scene/gltf_triangles.h"

namespace bespoke {
namespace {

/// The name of a mesh as a node shows it: the node's, else the mesh's, else its number.
std::string shown_name(const GltfFile& file, const GltfShown& shown) {
  const GltfPart node = file.root().elements("nodes")[shown.node];
  if (node.has("name")) return node.text("name");
  const GltfPart mesh = file.root().elements("meshes")[shown.mesh];
  return mesh.has("name") ? mesh.text("name") : "node " + std::to_string(shown.node);
}

}  // namespace

std::vector<std::string> find_gltf_face_groups(const InputFile& input, FaceGroupKind kind) {
  if (kind == FaceGroupKind::groups) return {};
  const GltfFile file = read_gltf(input);
  const std::vector<GltfAccessor> accessors = read_accessors(file);
  const GltfScene scene = read_scene(file, accessors);
  GatheredFaces gathered(file.path);
  std::vector<std::string> of_triangles;
  for (const GltfTriangles& triangles : shown_triangles(file, accessors, scene)) {
    gathered.add_points(triangles.places);
    std::string name = shown_name(file, scene.shown[triangles.shown]);
    if (kind == FaceGroupKind::materials) name += " " + std::to_string(triangles.primitive + 1);
    of_triangles.insert(of_triangles.end(), static_cast<std::size_t>(triangles.places.cols() / 3), name);
  }
  std::vector<std::string> of_faces;
  for (const std::size_t kept : kept_triangles(gathered.product(false).vertices))
    of_faces.push_back(of_triangles[kept]);
  return of_faces;
}

}  // namespace bespoke
