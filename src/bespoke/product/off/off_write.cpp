#include <ostream>
#include <string>
#include <string_view>

#include "bespoke/product/faces/face_formats.h"
#include "bespoke/product/faces/written_values.h"

namespace bespoke {

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

}  // namespace bespoke
