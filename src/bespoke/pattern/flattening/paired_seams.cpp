#include "bespoke/pattern/flattening/paired_seams.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "bespoke/error.h"

namespace bespoke {
namespace {

/// An edge of an outline: from its vertex number `at` to the next.
struct OutlineEdge {
  int piece = 0;
  int at = 0;
};

int next(int at, int step, std::size_t count) {
  const int size = static_cast<int>(count);
  return (at + step + size) % size;
}

/// The ends of an edge in the product, the lesser first.
std::pair<int, int> ends(const Piece& piece, int at) {
  const auto vertex = [&](int k) {
    return piece.vertices[static_cast<std::size_t>(piece.outline[static_cast<std::size_t>(k)])];
  };
  const int a = vertex(at), b = vertex(next(at, 1, piece.outline.size()));
  return {std::min(a, b), std::max(a, b)};
}

class SeamWalk {
 public:
  SeamWalk(const std::vector<Piece>& pieces, const std::string& product)
      : pieces_(pieces), other_(pieces.size()) {
    std::map<std::pair<int, int>, std::vector<OutlineEdge>> sides;
    for (std::size_t p = 0; p < pieces.size(); ++p) {
      other_[p].assign(pieces[p].outline.size(), {none, none});
      for (int at = 0; at < static_cast<int>(pieces[p].outline.size()); ++at)
        sides[ends(pieces[p], at)].push_back({static_cast<int>(p), at});
    }
    for (const auto& [edge, of_edge] : sides) {
      if (of_edge.size() > 2)
        throw InvalidInput(product + ": three pieces or more meet along the edge between vertices " +
                           std::to_string(edge.first + 1) + " and " + std::to_string(edge.second + 1) +
                           ": a seam joins two; separate the layers, or give them vertices of their own");
      if (of_edge.size() < 2) continue;
      other(of_edge[0]) = of_edge[1];
      other(of_edge[1]) = of_edge[0];
    }
  }

  std::vector<Seam> run() {
    std::vector<Seam> seams;
    for (int p = 0; p < static_cast<int>(pieces_.size()); ++p) {
      const int count = static_cast<int>(pieces_[static_cast<std::size_t>(p)].outline.size());
      int start = 0;  // begins a run, if there is a place between two runs
      while (start < count && continues({p, next(start, -1, outline_size(p))})) ++start;
      for (int k = 0; k < count; ++k) add({p, (start + k) % count}, seams);
    }
    return seams;
  }

 private:
  static constexpr int none = -1;

  std::size_t outline_size(int piece) const {
    return pieces_[static_cast<std::size_t>(piece)].outline.size();
  }
  OutlineEdge& other(const OutlineEdge& edge) {
    return other_[static_cast<std::size_t>(edge.piece)][static_cast<std::size_t>(edge.at)];
  }

  /// Whether edge and the next one of its outline are sewn to an edge and the one before it.
  bool continues(const OutlineEdge& edge) {
    const OutlineEdge after{edge.piece, next(edge.at, 1, outline_size(edge.piece))};
    const OutlineEdge a = other(edge), b = other(after);
    if (a.piece == none || a.piece != b.piece || b.at != next(a.at, -1, outline_size(a.piece))) return false;
    return !(a.piece == after.piece && a.at == after.at);  // the tip of a dart
  }

  void add(OutlineEdge edge, std::vector<Seam>& seams) {
    if (other(edge).piece == none) return;
    Seam seam;
    seam.sides[0].piece = edge.piece;
    seam.sides[1].piece = other(edge).piece;
    const auto vertex = [&](const OutlineEdge& of, int step) {
      const Piece& piece = pieces_[static_cast<std::size_t>(of.piece)];
      return piece.outline[static_cast<std::size_t>(next(of.at, step, piece.outline.size()))];
    };
    seam.sides[0].vertices.push_back(vertex(edge, 0));
    seam.sides[1].vertices.push_back(vertex(other(edge), 1));
    for (bool goes_on = true; goes_on;) {
      const OutlineEdge across = other(edge);
      seam.sides[0].vertices.push_back(vertex(edge, 1));
      seam.sides[1].vertices.push_back(vertex(across, 0));
      goes_on = continues(edge);
      other(edge) = {none, none};
      other(across) = {none, none};
      edge.at = next(edge.at, 1, outline_size(edge.piece));
      goes_on = goes_on && other(edge).piece != none;
    }
    seams.push_back(std::move(seam));
  }

  const std::vector<Piece>& pieces_;
  std::vector<std::vector<OutlineEdge>> other_;
};

}  // namespace

std::vector<Seam> paired_seams(const std::vector<Piece>& pieces, const std::string& product) {
  return SeamWalk(pieces, product).run();
}

double side_length(const SeamSide& side, const Eigen::MatrixXd& places) {
  double length = 0;
  for (std::size_t k = 0; k + 1 < side.vertices.size(); ++k)
    length += (places.col(side.vertices[k + 1]) - places.col(side.vertices[k])).norm();
  return length;
}

}  // namespace bespoke
