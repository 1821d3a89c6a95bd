#include "bespoke/product/vertex_groups.h"

#include <utility>

#include "bespoke/product/carry/product_formats.h"
#include "bespoke/product/posed_product.h"
#include "bespoke/strings.h"

namespace bespoke {

std::vector<std::string> vertex_groups(const std::filesystem::path& path, ModelPose pose) {
  const Points vertices = read_model(path, pose).vertices;
  const std::string ending = lower_ending(path);
  std::vector<std::string> groups;
  if (ending == ".obj") groups = find_obj_groups(InputFile(path));
  if (ending == ".gltf" || ending == ".glb") groups = find_gltf_groups(InputFile(path), vertices, pose);
  groups.resize(static_cast<std::size_t>(vertices.cols()));
  return groups;
}

}  // namespace bespoke
