#include "bespoke/product/gltf/document/gltf_extensions.h"

#include <algorithm>
#include <array>
#include <string>

#include "bespoke/error.h"

namespace bespoke {
namespace {

struct Compression {
  std::string_view extension, tools;  ///< that undo it
};
constexpr std::array compressions{
    Compression{"EXT_meshopt_compression", "gltfpack -noq or gltf-transform"},
    Compression{"KHR_meshopt_compression", "gltfpack -noq or gltf-transform"},
    Compression{"KHR_draco_mesh_compression",
                "gltf-transform, or by importing and exporting it with Blender"}};

// Required extensions under which a mesh is still where its accessors and nodes say: materials, textures
// (which are copied, not read), lights, avatars' own data, quantised accessors; instances are refused where a
// node shows them.
constexpr std::array<std::string_view, 14> harmless{"KHR_mesh_quantization",
                                                    "KHR_texture_",
                                                    "EXT_texture_",
                                                    "MSFT_texture_",
                                                    "KHR_materials_",
                                                    "KHR_lights_",
                                                    "EXT_lights_",
                                                    "KHR_xmp",
                                                    "VRM",
                                                    "EXT_mesh_features",
                                                    "EXT_structural_",
                                                    "KHR_audio",
                                                    "KHR_animation_pointer",
                                                    "EXT_mesh_gpu_instancing"};

std::string needs(const Compression& compression) {
  return "needs " + std::string(compression.extension) + ": decompress it with " +
         std::string(compression.tools);
}

}  // namespace

void require_known_extensions(const GltfPart& root) {
  const std::vector<std::string> required = root.texts("extensionsRequired");
  for (std::size_t i = 0; i < required.size(); ++i) {
    const std::string& name = required[i];
    const std::string where = root.path().string() + ": /extensionsRequired/" + std::to_string(i) + ": ";
    for (const Compression& compression : compressions)
      if (name == compression.extension) throw InvalidInput(where + needs(compression));
    const bool is_known = std::any_of(harmless.begin(), harmless.end(),
                                      [&](std::string_view known) { return name.starts_with(known); });
    if (!is_known)
      throw InvalidInput(where + "requires " + name +
                         ", which is not known here and may change shapes; export the file without it");
  }
}

void require_not_compressed(const GltfPart& part) {
  if (!part.has("extensions")) return;
  const GltfPart extensions = part.member("extensions");
  for (const Compression& compression : compressions)
    if (extensions.has(compression.extension.data()))
      throw InvalidInput(part.path().string() + ": " + part.pointer() + ": is compressed, " +
                         needs(compression));
}

}  // namespace bespoke
