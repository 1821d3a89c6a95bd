#include <optional>
#include <vector>

#include "bespoke/product/faces/face_formats.h"
#include "bespoke/product/faces/gathered_faces.h"
#include "bespoke/product/obj/obj_check.h"
#include "bespoke/product/obj/obj_statements.h"

namespace bespoke {
namespace {

constexpr int no_texture = -1;

/// What a block holds of a model.
struct BlockFaces {
  std::vector<NumberTriple> positions;
  std::vector<std::array<double, 2>> texture;
  std::vector<int> sizes, corners, corner_texture;  ///< from 0
  std::vector<int> line_edges;                      ///< vertices, by twos
  DegenerateFaces degenerate;
};

class FaceReader {
 public:
  FaceReader(const TextBlock& block, const std::filesystem::path& path) : words_(block, path, obj_syntax) {
    for (std::size_t kind = 0; kind < 3; ++kind) count_[kind] = static_cast<long long>(block.before[kind]);
  }

  BlockFaces run() {
    while (words_.next_line()) {
      switch (obj_statement(words_.word())) {
        case ObjStatement::position:
          faces_.positions.push_back(read_triple(words_));
          for (std::size_t axis = 0; axis < 3; ++axis)
            if (!fits_float(faces_.positions.back()[axis].value))
              words_.fail(std::string(1, "xyz"[axis]) + " is not finite in single precision");
          ++count_[0];
          break;
        case ObjStatement::texture:
          faces_.texture.push_back({words_.number("texture coordinate").value, second_coordinate()});
          ++count_[1];
          break;
        case ObjStatement::normal:
          ++count_[2];
          break;
        case ObjStatement::face:
          read_face();
          break;
        case ObjStatement::line:
          read_line();
          break;
        default:
          break;
      }
    }
    return std::move(faces_);
  }

 private:
  /// Textures may have one dimension.
  double second_coordinate() {
    TextWords ahead = words_;
    return ahead.word().empty() ? 0 : words_.number("texture coordinate").value;
  }

  void read_face() {
    const std::size_t begin = faces_.corners.size();
    for (std::string_view word = words_.word(); !word.empty(); word = words_.word()) {
      const std::optional<ObjCorner> corner = read_corner(word);
      if (!corner) words_.fail("the file has changed while it was read");
      faces_.corners.push_back(resolved(0, corner->index[0]));
      faces_.corner_texture.push_back(corner->index[1] == 0 ? no_texture : resolved(1, corner->index[1]));
    }
    faces_.sizes.push_back(static_cast<int>(faces_.corners.size() - begin));
    const std::string fault = face_fault(faces_.corners.data() + begin, faces_.corners.size() - begin, 1);
    if (!fault.empty()) add(faces_.degenerate, [&] { return words_.place() + ": " + fault; });
  }

  void read_line() {
    std::optional<int> before;
    for (std::string_view word = words_.word(); !word.empty(); word = words_.word()) {
      const std::optional<ObjCorner> corner = read_corner(word);
      if (!corner) words_.fail("the file has changed while it was read");
      const int vertex = resolved(0, corner->index[0]);
      if (before) faces_.line_edges.insert(faces_.line_edges.end(), {*before, vertex});
      before = vertex;
    }
  }

  int resolved(std::size_t kind, long long written) const {
    return static_cast<int>((written < 0 ? count_[kind] + 1 + written : written) - 1);
  }

  TextWords words_;
  std::array<long long, 3> count_{};
  BlockFaces faces_;
};

template <class Value>
void append(const std::vector<Value>& part, std::vector<Value>& all) {
  all.insert(all.end(), part.begin(), part.end());
}

}  // namespace

Product read_obj_faces(const InputFile& file) {
  // Checked as products are; from here on, numbers of vertices are known to be good.
  const ObjContent content = check_obj_product(file, {});
  require_countable(content.counts[0], file.path());
  require_countable(content.counts[1], file.path());
  Product product;
  product.has_normals = content.unused_normals < content.counts[2];
  product.vertices.resize(3, static_cast<Eigen::Index>(content.counts[0]));
  product.polygon_start.push_back(0);
  std::vector<std::array<double, 2>> texture;
  std::vector<int> corner_texture;
  Eigen::Index at = 0;
  TextCutter cutter(file.path(), 1, count_obj);
  walk_blocks(
      {file, 0}, [&](const Window& window) { return cutter(window); },
      [&](const TextBlock& block) { return FaceReader(block, file.path()).run(); },
      [&](const TextBlock&, BlockFaces&& block) {
        const auto count = static_cast<Eigen::Index>(block.positions.size());
        product.vertices.middleCols(at, count) = values(block.positions);
        at += count;
        for (const int size : block.sizes)
          product.polygon_start.push_back(product.polygon_start.back() + size);
        append(block.corners, product.corners);
        append(block.line_edges, product.line_edges);
        if (product.degenerate.count == 0) product.degenerate.first = block.degenerate.first;
        product.degenerate.count += block.degenerate.count;
        append(block.texture, texture);
        append(block.corner_texture, corner_texture);
      },
      {});
  if (std::all_of(corner_texture.begin(), corner_texture.end(), [](int t) { return t == no_texture; }))
    return product;
  product.texture = Eigen::Matrix2Xd::Zero(2, static_cast<Eigen::Index>(corner_texture.size()));
  for (std::size_t corner = 0; corner < corner_texture.size(); ++corner)
    if (corner_texture[corner] != no_texture)
      product.texture.col(static_cast<Eigen::Index>(corner)) =
          Eigen::Map<const Eigen::Vector2d>(texture[static_cast<std::size_t>(corner_texture[corner])].data());
  return product;
}

}  // namespace bespoke
