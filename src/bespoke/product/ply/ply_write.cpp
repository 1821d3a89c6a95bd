#include <algorithm>
#include <cstdint>
#include <limits>
#include <ostream>
#include <string>

#include "bespoke/product/faces/face_formats.h"
#include "bespoke/product/faces/written_values.h"

namespace bespoke {
namespace {

int longest_polygon(const Product& product) {
  int longest = 0;
  for (std::size_t polygon = 0; polygon < polygon_count(product); ++polygon)
    longest = std::max(longest, product.polygon_start[polygon + 1] - product.polygon_start[polygon]);
  return longest;
}

}  // namespace

void write_ply_faces(std::ostream& out, const WrittenFaces& faces) {
  const Product& product = faces.product;
  const std::string type = faces.as_doubles ? "double" : "float";
  out << "ply\nformat binary_little_endian 1.0\nelement vertex " << product.vertices.cols() << '\n';
  for (const char* axis : {"x", "y", "z"}) out << "property " << type << ' ' << axis << '\n';
  if (product.has_normals) out << "property float nx\nproperty float ny\nproperty float nz\n";
  const bool are_short = longest_polygon(product) <= std::numeric_limits<std::uint8_t>::max();
  out << "element face " << polygon_count(product) << "\nproperty list " << (are_short ? "uchar" : "uint")
      << " int vertex_indices\nend_header\n";
  std::string bytes;
  for (Eigen::Index i = 0; i < product.vertices.cols(); ++i) {
    append_vector(bytes, product.vertices.col(i), faces.as_doubles);
    if (product.has_normals) append_vector(bytes, faces.normals.col(i), false);
  }
  for (std::size_t polygon = 0; polygon < polygon_count(product); ++polygon) {
    const int begin = product.polygon_start[polygon], end = product.polygon_start[polygon + 1];
    if (are_short)
      append_bytes(bytes, static_cast<std::uint8_t>(end - begin));
    else
      append_bytes(bytes, static_cast<std::uint32_t>(end - begin));
    for (int k = begin; k < end; ++k) append_bytes(bytes, product.corners[static_cast<std::size_t>(k)]);
  }
  out << bytes;
}

}  // namespace bespoke
