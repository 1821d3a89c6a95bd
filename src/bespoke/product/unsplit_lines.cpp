#include "bespoke/product/unsplit_lines.h"

#include "bespoke/product/detail/gltf_file.h"
#include "bespoke/strings.h"

namespace bespoke {

std::size_t unsplit_line_primitives(const std::filesystem::path& path) {
  constexpr std::uint64_t first_mode = 1, last_mode = 3, triangles_mode = 4;  // lines, loops, strips
  const std::string ending = lower_ending(path);
  if (ending != ".glb" && ending != ".gltf") return 0;
  const InputFile input(path);
  const GltfFile file = read_gltf(input);
  std::size_t count = 0;
  for (const GltfPart& mesh : file.root().elements("meshes"))
    for (const GltfPart& primitive : mesh.elements("primitives")) {
      const std::uint64_t mode = primitive.whole_or("mode", triangles_mode);
      count += mode >= first_mode && mode <= last_mode;
    }
  return count;
}

}  // namespace bespoke
