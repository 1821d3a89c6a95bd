#include "bespoke/flow/detail/surface_pieces.h"

#include <algorithm>
#include <optional>

#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/disjoint_sets.h"

namespace bespoke {
namespace {

// Their mean says where the piece goes; more do not move it any better.
constexpr std::size_t links_per_piece = 8;

// Of the largest piece's area: from here on a piece is something that others are held by.
constexpr double large_piece = 0.1;

/// Closest points on the faces of some pieces, as faces of the whole mesh.
class PieceSurface {
 public:
  PieceSurface(const TriangleMesh& mesh, const Eigen::VectorXd& areas,
               const std::vector<SurfacePiece>& pieces, std::size_t count)
      : faces_(used_faces(areas, pieces, count)), tree_({mesh.vertices, mesh.faces(Eigen::all, faces_)}) {}

  PieceLink link(const TriangleMesh& mesh, int vertex) const {
    const SurfacePoint foot = tree_.closest(mesh.vertices.col(vertex)).value();
    return {vertex, faces_[static_cast<std::size_t>(foot.face)], foot.barycentric};
  }

 private:
  static std::vector<int> used_faces(const Eigen::VectorXd& areas, const std::vector<SurfacePiece>& pieces,
                                     std::size_t count) {
    std::vector<int> faces;
    for (std::size_t piece = 0; piece < count; ++piece)
      for (const int face : pieces[piece].faces)
        if (areas[face] > 0) faces.push_back(face);
    return faces;
  }

  std::vector<int> faces_;
  ClosestPointTree tree_;
};

}  // namespace

std::vector<SurfacePiece> surface_pieces(const TriangleMesh& mesh, const Eigen::VectorXd& areas) {
  const auto count = static_cast<int>(mesh.vertices.cols());
  DisjointSets sets(count);
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face)
    if (areas[face] > 0)
      for (int k = 1; k < 3; ++k) sets.join(mesh.faces(0, face), mesh.faces(k, face));
  std::vector<SurfacePiece> pieces;
  std::vector<std::size_t> piece_of(static_cast<std::size_t>(count));
  for (int vertex = 0; vertex < count; ++vertex) {
    const int first = sets.least(vertex);
    if (first == vertex) pieces.emplace_back();
    const std::size_t piece = first == vertex ? pieces.size() - 1 : piece_of[static_cast<std::size_t>(first)];
    piece_of[static_cast<std::size_t>(vertex)] = piece;
    pieces[piece].vertices.push_back(vertex);
  }
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    SurfacePiece& piece = pieces[piece_of[static_cast<std::size_t>(mesh.faces(0, face))]];
    piece.faces.push_back(static_cast<int>(face));
    piece.area += areas[face];
  }
  std::stable_sort(pieces.begin(), pieces.end(),
                   [](const SurfacePiece& a, const SurfacePiece& b) { return a.area > b.area; });
  return pieces;
}

std::vector<std::vector<PieceLink>> piece_links(const TriangleMesh& mesh, const Eigen::VectorXd& areas,
                                                const std::vector<SurfacePiece>& pieces) {
  std::vector<std::vector<PieceLink>> links(pieces.size());
  if (pieces.empty() || !(pieces.front().area > 0)) return links;
  std::optional<PieceSurface> surface;
  bool complete = false;  // `surface` holds all large pieces
  for (std::size_t i = 1; i < pieces.size(); ++i) {
    if (!complete) surface.emplace(mesh, areas, pieces, i);
    complete = complete || pieces[i].area < large_piece * pieces.front().area;
    const std::vector<int>& vertices = pieces[i].vertices;
    const std::size_t count = std::min(links_per_piece, vertices.size());
    for (std::size_t k = 0; k < count; ++k)
      links[i].push_back(surface->link(mesh, vertices[k * vertices.size() / count]));
  }
  return links;
}

}  // namespace bespoke
