#include "bespoke/product/faces/face_formats.h"
#include "bespoke/product/faces/gathered_faces.h"
#include "bespoke/product/off/off_text.h"

namespace bespoke {

Product read_off_faces(const InputFile& file) {
  const OffHeader header = read_off_header(file);
  require_countable(header.vertices, file.path());
  const bool is_cloud = header.has_normals && header.faces == 0;
  return gather_text(file, OffText(file.path(), header),
                     is_cloud ? GatheredNormals::of_points : GatheredNormals::none)
      .product(header.has_normals);
}

}  // namespace bespoke
