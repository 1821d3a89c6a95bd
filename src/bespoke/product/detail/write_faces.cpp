#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <limits>
#include <ostream>
#include <string>

#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/product/detail/face_formats.h"
#include "bespoke/product/detail/stl_file.h"

namespace bespoke {
namespace {

/// The shortest text that is read back as the same double, or float.
void append_number(std::string& text, double value, bool as_double) {
  std::array<char, 32> digits;
  const auto end =
      as_double ? std::to_chars(digits.data(), digits.data() + digits.size(), value)
                : std::to_chars(digits.data(), digits.data() + digits.size(), static_cast<float>(value));
  text.append(digits.data(), end.ptr);
}

void append_words(std::string& text, const auto& values, bool as_doubles) {
  for (const double value : values) {
    text += ' ';
    append_number(text, value, as_doubles);
  }
}

template <class Value>
void append_bytes(std::string& bytes, Value value) {
  static_assert(std::endian::native == std::endian::little);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void append_vector(std::string& bytes, const Vector3& vector, bool as_doubles) {
  for (const double value : vector)
    if (as_doubles)
      append_bytes(bytes, value);
    else
      append_bytes(bytes, static_cast<float>(value));
}

std::size_t polygon_count(const Product& product) {
  return product.polygon_start.empty() ? 0 : product.polygon_start.size() - 1;
}

int longest_polygon(const Product& product) {
  int longest = 0;
  for (std::size_t polygon = 0; polygon < polygon_count(product); ++polygon)
    longest = std::max(longest, product.polygon_start[polygon + 1] - product.polygon_start[polygon]);
  return longest;
}

/// A corner's words: its vertex, and what else of it is numbered.
void append_corner(std::string& text, const Product& product, int corner) {
  const std::string vertex = std::to_string(product.corners[static_cast<std::size_t>(corner)] + 1);
  const bool has_texture = product.texture.cols() > 0;
  text += ' ' + vertex;
  if (has_texture) text += '/' + std::to_string(corner + 1);
  if (product.has_normals) text += (has_texture ? "/" : "//") + vertex;
}

}  // namespace

void write_obj_faces(std::ostream& out, const WrittenFaces& faces) {
  const Product& product = faces.product;
  std::string text;
  const auto flush = [&] {
    out << text;
    text.clear();
  };
  for (Eigen::Index i = 0; i < product.vertices.cols(); ++i, flush()) {
    text += 'v';
    append_words(text, product.vertices.col(i), faces.as_doubles);
    text += '\n';
  }
  for (Eigen::Index i = 0; i < product.texture.cols(); ++i, flush()) {
    text += "vt";
    append_words(text, product.texture.col(i), false);
    text += '\n';
  }
  for (Eigen::Index i = 0; i < faces.normals.cols(); ++i, flush()) {
    text += "vn";
    append_words(text, faces.normals.col(i), false);
    text += '\n';
  }
  for (std::size_t polygon = 0; polygon < polygon_count(product); ++polygon, flush()) {
    text += 'f';
    for (int k = product.polygon_start[polygon]; k < product.polygon_start[polygon + 1]; ++k)
      append_corner(text, product, k);
    text += '\n';
  }
}

void write_off_faces(std::ostream& out, const WrittenFaces& faces) {
  const Product& product = faces.product;
  out << (product.has_normals ? "NOFF\n" : "OFF\n") << product.vertices.cols() << ' '
      << polygon_count(product) << " 0\n";
  std::string text;
  for (Eigen::Index i = 0; i < product.vertices.cols(); ++i) {
    text.clear();
    append_words(text, product.vertices.col(i), faces.as_doubles);
    if (product.has_normals) append_words(text, faces.normals.col(i), false);
    text += '\n';
    out << std::string_view(text).substr(1);
  }
  for (std::size_t polygon = 0; polygon < polygon_count(product); ++polygon) {
    const int begin = product.polygon_start[polygon], end = product.polygon_start[polygon + 1];
    text = std::to_string(end - begin);
    for (int k = begin; k < end; ++k)
      text += ' ' + std::to_string(product.corners[static_cast<std::size_t>(k)]);
    out << text << '\n';
  }
}

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
