#include <vector>

#include "bespoke/product/detail/face_formats.h"
#include "bespoke/product/detail/gathered_faces.h"
#include "bespoke/product/detail/ply_binary.h"
#include "bespoke/product/detail/ply_text.h"

namespace bespoke {
namespace {

/// A vertex block's positions and texture coordinates, or a face block's faces.
struct PlyContent {
  Points points;
  Eigen::Matrix2Xd texture;
  std::vector<std::uint32_t> faces;
};

template <std::size_t n>
Eigen::Matrix<double, int{n}, Eigen::Dynamic> read_vectors(
    const PlyHeader& header, const PlyBlock& block, const std::vector<std::array<std::size_t, n>>& offsets,
    const std::array<std::size_t, n>& properties) {
  Eigen::Matrix<double, int{n}, Eigen::Dynamic> result(n, static_cast<Eigen::Index>(offsets.size()));
  const std::vector<PlyProperty>& all = header.elements[block.element].properties;
  for (std::size_t i = 0; i < offsets.size(); ++i)
    for (std::size_t k = 0; k < n; ++k)
      result(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) =
          read_value(block.bytes.data() + offsets[i][k], all[properties[k]].type, header.encoding);
  return result;
}

PlyContent read_block(const PlyHeader& header, const PlyBlock& block) {
  PlyContent content;
  if (block.count == 0) return content;
  if (block.element == header.vertex) {
    const PlyOffsets offsets = vertex_offsets(header, block);
    content.points = read_vectors(header, block, offsets.position, header.position);
    if (header.texture) content.texture = read_vectors(header, block, offsets.texture, *header.texture);
  } else if (header.elements[block.element].name == "face") {
    content.faces = face_corners(header, block);
  }
  return content;
}

GatheredFaces gather_binary_ply(const InputFile& file, const PlyHeader& header) {
  GatheredFaces gathered(file.path());
  PlyCutter cutter(file, header);
  walk_blocks(
      file, header.size, [&](const Window& window) { return cutter(window); },
      [&](const PlyBlock& block) { return read_block(header, block); },
      [&](const PlyBlock&, PlyContent&& content) {
        if (content.points.cols() > 0) gathered.add_points(content.points);
        if (content.texture.cols() > 0) gathered.add_texture(content.texture);
        gathered.add_faces(content.faces);
      },
      {});
  return gathered;
}

}  // namespace

Product read_ply_faces(const InputFile& file) {
  const PlyHeader header = read_ply_header(file);
  require_countable(header.elements[header.vertex].count, file.path());
  GatheredFaces gathered = header.encoding == PlyHeader::Encoding::ascii
                               ? gather_text(file, PlyText(file.path(), header))
                               : gather_binary_ply(file, header);
  return gathered.product(header.normal.has_value());
}

}  // namespace bespoke
