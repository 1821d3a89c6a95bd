#include <ostream>
#include <string>

#include "bespoke/product/faces/face_formats.h"
#include "bespoke/product/faces/written_values.h"

namespace bespoke {
namespace {

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

}  // namespace bespoke
