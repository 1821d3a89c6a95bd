#include "bespoke/product/faces/gathered_faces.h"
#include "bespoke/product/gltf/scene/gltf_triangles.h"
#include "bespoke/product/product_io.h"
#include "bespoke/strings.h"

namespace bespoke {
namespace {

/// Of one primitive: zeros where it has none.
Eigen::Matrix2Xd texture_of(const GltfFile& file, const std::vector<GltfAccessor>& accessors,
                            const GltfPart& primitive, const std::vector<std::uint32_t>& corners) {
  const auto accessor = primitive.member("attributes").index("TEXCOORD_0", accessors.size());
  if (!accessor) return Eigen::Matrix2Xd::Zero(2, static_cast<Eigen::Index>(corners.size()));
  const GltfAccessor& of = accessors[*accessor];
  if (of.components != 2) primitive.fail("its texture coordinates are no VEC2");
  const Eigen::Matrix2Xd values = read_values(of, file.buffers, 0, of.count).cast<double>();
  Eigen::Matrix2Xd texture(2, static_cast<Eigen::Index>(corners.size()));
  for (std::size_t k = 0; k < corners.size(); ++k) {
    if (corners[k] >= of.count)
      primitive.fail("names vertex " + std::to_string(corners[k]) + " of " + std::to_string(of.count) +
                     " texture coordinates");
    const auto value = values.col(static_cast<Eigen::Index>(corners[k]));
    texture.col(static_cast<Eigen::Index>(k)) << value[0], 1 - value[1];
  }
  return texture;
}

}  // namespace

Eigen::Matrix2Xd corner_texture(const std::filesystem::path& path) {
  const std::string ending = lower_ending(path);
  if (ending != ".gltf" && ending != ".glb") return {};
  const InputFile input(path);  // which the file reads from as long as it lives
  const GltfFile file = read_gltf(input);
  const std::vector<GltfAccessor> accessors = read_accessors(file);
  const GltfScene scene = read_scene(file, accessors);
  GatheredFaces gathered(file.path);
  std::vector<Eigen::Matrix2Xd> parts;
  bool has_any = false;
  for (const GltfTriangles& triangles : shown_triangles(file, accessors, scene)) {
    const GltfPart primitive = file.root().elements("meshes")[scene.shown[triangles.shown].mesh].elements(
        "primitives")[triangles.primitive];
    has_any = has_any || primitive.member("attributes").has("TEXCOORD_0");
    gathered.add_points(triangles.places);
    parts.push_back(texture_of(file, accessors, primitive, triangles.corners));
  }
  if (!has_any) return {};
  const Points corners = gathered.product(false).vertices;
  Eigen::Matrix2Xd all(2, corners.cols());
  Eigen::Index at = 0;
  for (const Eigen::Matrix2Xd& part : parts) {
    all.middleCols(at, part.cols()) = part;
    at += part.cols();
  }
  const std::vector<std::size_t> kept = kept_triangles(corners);
  Eigen::Matrix2Xd texture(2, 3 * static_cast<Eigen::Index>(kept.size()));
  for (std::size_t k = 0; k < kept.size(); ++k)
    texture.middleCols<3>(3 * static_cast<Eigen::Index>(k)) =
        all.middleCols<3>(3 * static_cast<Eigen::Index>(kept[k]));
  return texture;
}

}  // namespace bespoke
