#include "bespoke/exchange/glb_file.h"
#include "bespoke/pattern/sheet/sheet_formats.h"

namespace bespoke {

void write_glb_pieces(const std::filesystem::path& path, const FlatPattern& pattern, const Sheet& sheet,
                      const PatternFileOptions& options) {
  Eigen::Index vertices = 0;
  for (const PatternPiece& piece : pattern.pieces) vertices += piece.flat.cols();
  MorphingMesh mesh;
  mesh.product.vertices = Points::Zero(3, vertices);
  mesh.product.polygon_start.push_back(0);
  mesh.product.has_normals = true;
  mesh.targets.emplace_back(3, vertices);
  Eigen::Index first = 0;
  for (std::size_t p = 0; p < pattern.pieces.size(); ++p) {
    const PatternPiece& piece = pattern.pieces[p];
    const Eigen::Index count = piece.flat.cols();
    mesh.product.vertices.block(0, first, 2, count) =
        piece.flat.colwise() + sheet_shift(piece, sheet.pieces[p]);
    mesh.targets.front().middleCols(first, count) = piece.piece.mesh.vertices;
    for (const int vertex : piece.piece.mesh.faces.reshaped())
      mesh.product.corners.push_back(static_cast<int>(first) + vertex);
    for (Eigen::Index f = 0; f < piece.piece.mesh.faces.cols(); ++f)
      mesh.product.polygon_start.push_back(mesh.product.polygon_start.back() + 3);
    first += count;
  }
  constexpr double metres_per_millimetre = 1e-3;
  write_glb(path, mesh, {options.name, metres_per_millimetre});
}

}  // namespace bespoke
