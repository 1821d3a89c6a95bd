#include <algorithm>
#include <string>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/product/faces/face_formats.h"
#include "bespoke/product/faces/gathered_faces.h"
#include "bespoke/product/ply/ply_binary.h"
#include "bespoke/product/ply/ply_records.h"
#include "bespoke/product/ply/ply_text.h"

namespace bespoke {
namespace {

bool has(const PlyHeader& header, const std::string& name) {
  return std::any_of(header.elements.begin(), header.elements.end(),
                     [&](const auto& element) { return element.name == name && element.count > 0; });
}

/// Whether the file is a point cloud with normals; of a mesh these are not read.
bool shows_directions(const PlyHeader& header) { return header.normal && !has(header, "face"); }

/// A model whose surface is stored otherwise is no point cloud.
void require_no_strips(const PlyHeader& header, const std::filesystem::path& path) {
  if (has(header, "tristrips") && !has(header, "face"))
    throw FormatError(
        path.string() +
        ": its faces are triangle strips (element tristrips), which are not read; store them as "
        "triangles (element face, property list vertex_indices)");
}

/// A vertex block's positions, normals and texture coordinates, or a face block's faces.
struct PlyContent {
  Points points;
  Points normals;
  Eigen::Matrix2Xd texture;
  std::vector<std::uint32_t> faces;
};

PlyContent read_block(const PlyHeader& header, const PlyBlock& block, const std::filesystem::path& path) {
  PlyContent content;
  content.faces = face_corners(header, block, path);
  if (block.element != header.vertex || block.count == 0) return content;
  const PlyPlaces places(header, block);
  content.points.resize(3, static_cast<Eigen::Index>(block.count));
  places.read(header.position, content.points.data());
  if (shows_directions(header)) {
    content.normals.resize(3, content.points.cols());
    places.read(*header.normal, content.normals.data());
  }
  if (!header.texture) return content;
  content.texture.resize(2, static_cast<Eigen::Index>(block.count));
  places.read(*header.texture, content.texture.data());
  return content;
}

GatheredFaces gather_binary_ply(const InputFile& file, const PlyHeader& header) {
  GatheredFaces gathered(file.path());
  PlyCutter cutter(file, header);
  walk_blocks(
      {file, header.size}, [&](const Window& window) { return cutter(window); },
      [&](const PlyBlock& block) { return read_block(header, block, file.path()); },
      [&](const PlyBlock&, PlyContent&& content) {
        if (content.points.cols() > 0) gathered.add_points(content.points);
        if (content.normals.cols() > 0) gathered.add_normals(content.normals);
        if (content.texture.cols() > 0) gathered.add_texture(content.texture);
        gathered.add_faces(content.faces);
      },
      {});
  return gathered;
}

/// The ends of the file's lines, by twos.
std::vector<int> line_edges(const InputFile& file, const PlyHeader& header) {
  std::vector<int> ends;
  const std::optional<PlyEdges> edges = ply_edges(header);
  if (!edges) return ends;
  const std::string text = file.content();
  const PlyRecords records(file, text, header);
  for (std::size_t i = 0; i < header.elements[edges->element].count; ++i) {
    const PlyValues record = records.values(edges->element, i);
    for (const std::size_t end : edges->ends) {
      const double vertex = record[end][0].value;
      const std::string fault = ply_index_fault(vertex, header.elements[header.vertex].count);
      if (!fault.empty())
        throw FormatError(file.path().string() + ": edge " + std::to_string(i) + ": " + fault);
      ends.push_back(static_cast<int>(vertex));
    }
  }
  return ends;
}

}  // namespace

Product read_ply_faces(const InputFile& file) {
  const PlyHeader header = read_ply_header(file);
  require_no_strips(header, file.path());
  require_countable(header.elements[header.vertex].count, file.path());
  GatheredFaces gathered =
      header.encoding == PlyHeader::Encoding::ascii
          ? gather_text(file, PlyText(file.path(), header),
                        shows_directions(header) ? GatheredNormals::of_points : GatheredNormals::none)
          : gather_binary_ply(file, header);
  Product product = gathered.product(header.normal.has_value());
  product.line_edges = line_edges(file, header);
  return product;
}

}  // namespace bespoke
