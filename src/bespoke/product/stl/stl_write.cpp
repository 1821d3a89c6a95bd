#include <cstdint>
#include <ostream>
#include <string>

#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/product/faces/face_formats.h"
#include "bespoke/product/faces/written_values.h"
#include "bespoke/product/stl/stl_file.h"

namespace bespoke {

void write_stl_faces(std::ostream& out, const WrittenFaces& faces) {
  // Of the corners as they are stored, so that they are the same when the file is read and written again.
  const TriangleMesh mesh{faces.product.vertices.cast<float>().cast<double>(), triangulated(faces.product)};
  const Points normals = face_normals(mesh);
  std::string bytes(stl_header_size - sizeof(std::uint32_t), ' ');
  append_bytes(bytes, static_cast<std::uint32_t>(mesh.faces.cols()));
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    append_vector(bytes, normals.col(face), false);
    for (int k = 0; k < 3; ++k) append_vector(bytes, mesh.vertices.col(mesh.faces(k, face)), false);
    append_bytes(bytes, std::uint16_t{0});
  }
  out << bytes;
}

}  // namespace bespoke
