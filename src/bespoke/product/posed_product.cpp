#include "bespoke/product/posed_product.h"

#include "bespoke/product/faces/face_formats.h"
#include "bespoke/product/format_unit.h"
#include "bespoke/product/gltf/scene/gltf_nodes.h"
#include "bespoke/strings.h"

namespace bespoke {
namespace {

bool is_gltf(const std::filesystem::path& path) {
  const std::string ending = lower_ending(path);
  return ending == ".glb" || ending == ".gltf";
}

}  // namespace

Product read_product(const std::filesystem::path& path, ModelPose pose) {
  if (pose == ModelPose::shown || !is_gltf(path)) return read_product(path);
  Product product = read_stored_gltf_faces(InputFile(path));
  product.unit = unit_of_format(path);
  return product;
}

Product read_model(const std::filesystem::path& path, ModelPose pose) {
  if (!is_gltf(path)) return read_product(path);
  Product product = read_gltf_model_faces(InputFile(path), pose);
  product.unit = unit_of_format(path);
  return product;
}

bool has_two_poses(const std::filesystem::path& path) {
  if (!is_gltf(path)) return false;
  const InputFile input(path);
  const GltfFile file = read_gltf(input);
  return read_scene(file, read_accessors(file)).posed > 0;
}

}  // namespace bespoke
