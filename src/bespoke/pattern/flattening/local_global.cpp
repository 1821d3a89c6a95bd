#include "bespoke/pattern/flattening/local_global.h"

#include <algorithm>
#include <cmath>

#include "bespoke/error.h"
#include "bespoke/parallel.h"
#include "bespoke/pattern/flattening/nearest_stretch.h"
#include "bespoke/pattern/flattening/paired_seams.h"

namespace bespoke {
namespace {

/// Both edges with the length that they have in the mean, but for what the first eases.
std::array<Eigen::Vector2d, 2> of_mean_length(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                                              double ease) {
  const double one = a.norm(), other = b.norm(), mean = (one + other) / 2;
  if (!(one > 0 && other > 0 && mean > std::abs(ease) / 2)) return {a, b};
  return {a * ((mean + ease / 2) / one), b * ((mean - ease / 2) / other)};
}

/// n×n without the row and column of one vertex, whose neighbours' values go to the other side.
constexpr int anchored = -1;

}  // namespace

struct LocalGlobal::Part {
  const Piece* piece = nullptr;
  std::vector<RestFace> rest;
  double area = 0;
  int begin = 0;  ///< its first column in a state
  int pin = 0;    ///< the vertex that stays
  Eigen::SparseMatrix<double> faces;
  Eigen::SparseMatrix<double> matrix;  ///< with the seams
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> cholesky;

  int unknown(int vertex) const { return vertex == pin ? anchored : vertex - (vertex > pin ? 1 : 0); }
  Eigen::Matrix2d jacobian(const FlatState& x, Eigen::Index face) const {
    const Eigen::Vector3i columns = piece->mesh.faces.col(face).array() + begin;
    return face_jacobian(rest[static_cast<std::size_t>(face)], columns, x);
  }
};

LocalGlobal::LocalGlobal(const std::vector<Piece>& pieces, const std::vector<Seam>& seams,
                         FlatteningMethod method)
    : method_(method) {
  int begin = 0;
  for (const Piece& piece : pieces) {
    auto part = std::make_shared<Part>();
    part->piece = &piece;
    part->rest = rest_faces(piece.mesh);
    for (const RestFace& face : part->rest) part->area += face.area;
    part->begin = begin;
    part->pin = piece.outline.front();
    part->faces = stiffness(piece.mesh, part->rest);
    begin += static_cast<int>(piece.mesh.vertices.cols());
    parts_.push_back(std::move(part));
  }
  for (const Seam& seam : seams) {
    const auto step = [&](std::size_t k) {
      const Points& x = pieces[static_cast<std::size_t>(seam.sides[0].piece)].mesh.vertices;
      return (x.col(seam.sides[0].vertices[k + 1]) - x.col(seam.sides[0].vertices[k])).norm();
    };
    const double length =
        seam.ease == 0
            ? 1
            : side_length(seam.sides[0], pieces[static_cast<std::size_t>(seam.sides[0].piece)].mesh.vertices);
    for (std::size_t k = 0; k + 1 < seam.sides[0].vertices.size(); ++k) {
      PairedEdge pair;
      for (std::size_t side = 0; side < 2; ++side) {
        const SeamSide& of = seam.sides[side];
        const int first = parts_[static_cast<std::size_t>(of.piece)]->begin;
        pair.ends[side] = {first + of.vertices[k], first + of.vertices[k + 1]};
      }
      pair.weight =
          1;  // the cotangent weight of an edge between equilateral triangles is 2 · ½ cot 60° = 0.58
      if (seam.ease != 0) pair.ease = seam.ease * step(k) / length;
      paired_.push_back(pair);
    }
  }
}

void LocalGlobal::set_seam_weight(double weight) {
  seam_weight_ = weight;
  std::vector<std::vector<Eigen::Triplet<double>>> seams(parts_.size());
  for (const PairedEdge& pair : paired_)
    for (const auto& [from, to] : pair.ends) {
      const auto part = std::upper_bound(parts_.begin(), parts_.end(), from,
                                         [](int column, const auto& p) { return column < p->begin; }) -
                        parts_.begin() - 1;
      const int begin = parts_[static_cast<std::size_t>(part)]->begin;
      const double w = weight * pair.weight;
      auto& entries = seams[static_cast<std::size_t>(part)];
      for (const auto& [i, j, value] : {std::tuple(from, from, w), std::tuple(to, to, w),
                                        std::tuple(from, to, -w), std::tuple(to, from, -w)})
        entries.emplace_back(i - begin, j - begin, value);
    }
  parallel_for(parts_.size(), 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t p = first; p < last; ++p) {
      Part& part = *parts_[p];
      Eigen::SparseMatrix<double> own(part.faces.rows(), part.faces.cols());
      own.setFromTriplets(seams[p].begin(), seams[p].end());
      part.matrix = part.faces + own;
      std::vector<Eigen::Triplet<double>> entries;
      for (int column = 0; column < part.matrix.outerSize(); ++column)
        for (Eigen::SparseMatrix<double>::InnerIterator entry(part.matrix, column); entry; ++entry)
          if (entry.row() != part.pin && column != part.pin)
            entries.emplace_back(part.unknown(static_cast<int>(entry.row())), part.unknown(column),
                                 entry.value());
      Eigen::SparseMatrix<double> reduced(part.matrix.rows() - 1, part.matrix.cols() - 1);
      reduced.setFromTriplets(entries.begin(), entries.end());
      part.cholesky.compute(reduced);
      if (part.cholesky.info() != Eigen::Success)
        throw SolverError("piece '" + part.piece->name +
                          "': the system of its flattening cannot be factorised; " +
                          "it has faces far thinner than doubles resolve");
    }
  });
}

double LocalGlobal::scale_of_targets(const Part& part, const FlatState& x) const {
  if (method_ != FlatteningMethod::conformal) return 1;
  double area = 0;
  for (Eigen::Index f = 0; f < part.piece->mesh.faces.cols(); ++f)
    area += part.rest[static_cast<std::size_t>(f)].area *
            nearest_stretch(method_, part.jacobian(x, f)).determinant();
  return std::sqrt(part.area / area);
}

double LocalGlobal::energy(const FlatState& x) const {
  std::vector<double> energies(parts_.size(), 0);
  parallel_for(parts_.size(), 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t p = first; p < last; ++p) {
      const Part& part = *parts_[p];
      const double scale = scale_of_targets(part, x);
      for (Eigen::Index f = 0; f < part.piece->mesh.faces.cols(); ++f) {
        const Eigen::Matrix2d jacobian = part.jacobian(x, f);
        energies[p] += part.rest[static_cast<std::size_t>(f)].area *
                       (jacobian - scale * nearest_stretch(method_, jacobian)).squaredNorm();
      }
    }
  });
  double sum = 0;
  for (const double energy : energies) sum += energy;
  for (const PairedEdge& pair : paired_) {
    const double one = (x.col(pair.ends[0][1]) - x.col(pair.ends[0][0])).norm();
    const double other = (x.col(pair.ends[1][1]) - x.col(pair.ends[1][0])).norm();
    const double gap = one - other - pair.ease;
    sum += seam_weight_ * pair.weight * gap * gap / 2;
  }
  return sum;
}

bool LocalGlobal::is_unflipped(const FlatState& x) const {
  for (const auto& part : parts_)
    for (Eigen::Index f = 0; f < part->piece->mesh.faces.cols(); ++f)
      if (!(part->jacobian(x, f).determinant() > 0)) return false;
  return true;
}

FlatState LocalGlobal::next(const FlatState& x) const {
  FlatState right = FlatState::Zero(2, x.cols());
  for (const PairedEdge& pair : paired_) {
    const auto targets = of_mean_length(x.col(pair.ends[0][1]) - x.col(pair.ends[0][0]),
                                        x.col(pair.ends[1][1]) - x.col(pair.ends[1][0]), pair.ease);
    for (std::size_t side = 0; side < 2; ++side) {
      right.col(pair.ends[side][1]) += seam_weight_ * pair.weight * targets[side];
      right.col(pair.ends[side][0]) -= seam_weight_ * pair.weight * targets[side];
    }
  }
  FlatState result = x;
  parallel_for(parts_.size(), 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t p = first; p < last; ++p) {
      const Part& part = *parts_[p];
      const TriangleMesh& mesh = part.piece->mesh;
      const double scale = scale_of_targets(part, x);
      for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
        const RestFace& rest = part.rest[static_cast<std::size_t>(f)];
        const Eigen::Matrix2d target = rest.area * scale * nearest_stretch(method_, part.jacobian(x, f));
        for (int k = 0; k < 3; ++k)
          right.col(part.begin + mesh.faces(k, f)) += target * rest.gradients.col(k);
      }
      const Eigen::Index n = mesh.vertices.cols();
      const Eigen::Vector2d pinned = x.col(part.begin + part.pin);
      for (Eigen::SparseMatrix<double>::InnerIterator entry(part.matrix, part.pin); entry; ++entry)
        right.col(part.begin + entry.row()) -= entry.value() * pinned;
      Eigen::MatrixX2d reduced(n - 1, 2);
      for (int v = 0; v < static_cast<int>(n); ++v)
        if (v != part.pin) reduced.row(part.unknown(v)) = right.col(part.begin + v).transpose();
      const Eigen::MatrixX2d solution = part.cholesky.solve(reduced);
      for (int v = 0; v < static_cast<int>(n); ++v)
        if (v != part.pin) result.col(part.begin + v) = solution.row(part.unknown(v)).transpose();
    }
  });
  return result;
}

double LocalGlobal::unflipped_step(const FlatState& x, const FlatState& to) const {
  constexpr double margin = 0.9;  // of the step to where a face would have no area
  double smallest = 1 / margin;
  const FlatState direction = to - x;
  for (const auto& part : parts_)
    for (Eigen::Index f = 0; f < part->piece->mesh.faces.cols(); ++f)
      smallest =
          std::min(smallest, bespoke::unflipped_step(part->jacobian(x, f), part->jacobian(direction, f)));
  return margin * smallest;
}

FlatState LocalGlobal::joined(const std::vector<Eigen::Matrix2Xd>& flat) const {
  const Part& last = *parts_.back();
  FlatState x(2, last.begin + last.piece->mesh.vertices.cols());
  for (std::size_t p = 0; p < parts_.size(); ++p) x.middleCols(parts_[p]->begin, flat[p].cols()) = flat[p];
  return x;
}

std::vector<Eigen::Matrix2Xd> LocalGlobal::parted(const FlatState& x) const {
  std::vector<Eigen::Matrix2Xd> flat;
  for (const auto& part : parts_)
    flat.push_back(x.middleCols(part->begin, part->piece->mesh.vertices.cols()));
  return flat;
}

}  // namespace bespoke
