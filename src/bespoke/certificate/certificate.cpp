#include "bespoke/certificate/certificate.h"

#include <Eigen/LU>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "bespoke/certificate/jacobian_bound.h"
#include "bespoke/error.h"
#include "bespoke/lattice/finest_cells.h"
#include "bespoke/lattice/leaf_table.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

constexpr std::size_t largest_number_of_places = 1000;
constexpr std::size_t roots_per_step = 64;
constexpr double unit_roundoff = 0x1p-53;

struct Found {
  std::size_t certified = 0;
  std::size_t undecided = 0;
  std::size_t folded = 0;
  double least = std::numeric_limits<double>::infinity();
  std::vector<FoldedCell> places;
};

Found combine(Found a, const Found& b) {
  a.certified += b.certified;
  a.undecided += b.undecided;
  a.folded += b.folded;
  a.least = std::min(a.least, b.least);
  a.places.insert(a.places.end(), b.places.begin(), b.places.end());
  return a;
}

class Certifier {
 public:
  Certifier(const Pyramid& pyramid, const Matrix3& affine, double t)
      : pyramid_(pyramid),
        index_(pyramid),
        linear_((1 - t) * Matrix3::Identity() + t * affine),
        linear_error_(4 * unit_roundoff * (std::abs(1 - t) + std::abs(t) * affine.cwiseAbs().maxCoeff())),
        t_(t) {
    // Each level rounds three times when it is interpolated and once when it is added.
    sum_error_ = 4 * static_cast<double>(pyramid.levels.size() + 1) * unit_roundoff * largest_sum(pyramid);
  }

  std::size_t roots() const { return index_.levels.empty() ? 0 : index_.levels.front().size(); }

  const PyramidIndex& index() const { return index_; }

  Found certify_roots(std::size_t begin, std::size_t end) const {
    Found found;
    for (std::size_t root = begin; root < end; ++root)
      visit_finest_cells(index_, root, [&](const EntryCells& cells) { certify_entry(cells, found); });
    return found;
  }

  void certify_entry(const EntryCells& cells, Found& found) const {
    const double voxel_size = pyramid_.levels[static_cast<std::size_t>(cells.level)].voxel_size;
    JacobianBlock block;
    bound_block(*cells.sum, linear_, t_ / voxel_size, linear_error_ + std::abs(t_) / voxel_size * sum_error_,
                block);
    for (int cell = 0; cell < leaf_nodes; ++cell) {
      if (!cells.finest[static_cast<std::size_t>(cell)]) continue;
      if (block.lower_bound[cell] > 0) {
        ++found.certified;
        found.least = std::min(found.least, block.lower_bound[cell]);
        continue;
      }
      const DeterminantRange range =
          decide_cell(bezier_coefficients(*cells.sum, cell, linear_, t_ / voxel_size), block.margin);
      if (range.verdict == CellVerdict::certified) {
        ++found.certified;
        found.least = std::min(found.least, range.lower_bound);
        continue;
      }
      ++(range.verdict == CellVerdict::folded ? found.folded : found.undecided);
      found.places.push_back({cells.level, center(cells, cell, voxel_size), range.value});
    }
  }

 private:
  Vector3 center(const EntryCells& cells, int cell, double voxel_size) const {
    const Vector3 corner(leaf_edge * cells.leaf[0] + cell / 64, leaf_edge * cells.leaf[1] + cell / 8 % 8,
                         leaf_edge * cells.leaf[2] + cell % 8);
    return pyramid_.origin + voxel_size * (corner + Vector3::Constant(0.5));
  }

  const Pyramid& pyramid_;
  PyramidIndex index_;
  Matrix3 linear_;
  double linear_error_;
  double t_;
  double sum_error_ = 0;
};

}  // namespace

std::string to_string(const Certificate& certificate) {
  char text[256];
  std::snprintf(
      text, sizeof text,
      "%zu cells certified, %zu undecided, %zu folded; least determinant %.4g, of the affine part %.4g%s; "
      "%.2f s",
      certificate.certified, certificate.undecided, certificate.folded, certificate.least_determinant,
      certificate.affine_determinant, certificate.is_bijection() ? "; a bijection of space" : "",
      certificate.seconds);
  return text;
}

Certificate certify(const Pyramid& pyramid, const AffineMap& affine, double t, const Progress& progress) {
  Certificate certificate = certify_listing_all(pyramid, affine, t, progress);
  if (certificate.places.size() > largest_number_of_places)
    certificate.places.resize(largest_number_of_places);
  return certificate;
}

Certificate certify_listing_all(const Pyramid& pyramid, const AffineMap& affine, double t,
                                const Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  require_valid(pyramid);
  if (!std::isfinite(t)) throw InvalidInput("the time t of a certificate is not finite");
  if (!(affine.linear.allFinite() && affine.offset.allFinite()))
    throw InvalidInput("the affine part of a map to certify is not finite");
  const Matrix3 linear = (1 - t) * Matrix3::Identity() + t * affine.linear;
  const Certifier certifier(pyramid, affine.linear, t);
  Found found;
  for (std::size_t first = 0; first < certifier.roots(); first += roots_per_step) {
    progress.step("certify", first, certifier.roots());
    const std::size_t count = std::min(roots_per_step, certifier.roots() - first);
    found = combine(std::move(found), parallel_reduce(
                                          count, 1, Found{},
                                          [&](std::size_t begin, std::size_t end) {
                                            return certifier.certify_roots(first + begin, first + end);
                                          },
                                          combine));
  }
  progress.step("certify", certifier.roots(), certifier.roots());
  Certificate certificate;
  certificate.certified = found.certified;
  certificate.undecided = found.undecided;
  certificate.folded = found.folded;
  certificate.affine_determinant = linear.determinant();
  certificate.least_determinant = std::min(found.least, certificate.affine_determinant);
  certificate.places = std::move(found.places);
  certificate.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return certificate;
}

struct FoldList::Cells {
  Cells(const Pyramid& pyramid_in, const AffineMap& affine)
      : pyramid(pyramid_in), certifier(pyramid_in, affine.linear, 1) {}

  const Pyramid& pyramid;
  Certifier certifier;  // refers to the values, so it sees their changes
};

FoldList::FoldList(const Pyramid& pyramid, const AffineMap& affine, std::vector<FoldedCell> places)
    : cells_(std::make_unique<Cells>(pyramid, affine)), places_(std::move(places)) {}

FoldList::~FoldList() = default;

void FoldList::update(const std::vector<std::vector<std::array<int, 3>>>& changed) {
  const Pyramid& pyramid = cells_->pyramid;
  const PyramidIndex& index = cells_->certifier.index();
  // Entries with a cell at a changed node, and the way down to them. What lies below them changes as well.
  std::vector<LeafTable> stale(pyramid.levels.size()), above(pyramid.levels.size());
  const auto insert = [](LeafTable& table, const LeafCoordinates& leaf) {
    if (table.find(leaf) != no_leaf) return false;
    table.insert(leaf, 0);
    return true;
  };
  for (std::size_t level = 0; level < changed.size(); ++level)
    for (const std::array<int, 3>& node : changed[level])
      for (int corner = 0; corner < 8; ++corner) {
        LeafCoordinates leaf = {(node[0] - (corner >> 2 & 1)) >> 3, (node[1] - (corner >> 1 & 1)) >> 3,
                                (node[2] - (corner & 1)) >> 3};
        if (!insert(stale[level], leaf)) continue;
        for (std::size_t up = level; up-- > 0;) {
          leaf = {leaf[0] >> 1, leaf[1] >> 1, leaf[2] >> 1};
          if (!insert(above[up], leaf)) break;
        }
      }
  const auto is_stale = [&](int level, LeafCoordinates leaf) {
    for (; level >= 0; --level, leaf = {leaf[0] >> 1, leaf[1] >> 1, leaf[2] >> 1})
      if (stale[static_cast<std::size_t>(level)].find(leaf) != no_leaf) return true;
    return false;
  };
  const auto leaf_of = [&](const FoldedCell& cell) -> LeafCoordinates {
    const double voxel_size = pyramid.levels[static_cast<std::size_t>(cell.level)].voxel_size;
    const Eigen::Vector3i node = ((cell.center - pyramid.origin) / voxel_size).array().floor().cast<int>();
    return {node.x() >> 3, node.y() >> 3, node.z() >> 3};
  };
  std::erase_if(places_, [&](const FoldedCell& cell) { return is_stale(cell.level, leaf_of(cell)); });
  std::vector<std::size_t> roots;
  for (std::size_t root = 0; root < cells_->certifier.roots(); ++root) {
    const LeafCoordinates& leaf = index.levels.front()[root].leaf;
    if (stale.front().find(leaf) != no_leaf || above.front().find(leaf) != no_leaf) roots.push_back(root);
  }
  const Found found = parallel_reduce(
      roots.size(), 1, Found{},
      [&](std::size_t begin, std::size_t end) {
        Found part;
        for (std::size_t n = begin; n < end; ++n)
          visit_finest_cells(
              index, roots[n],
              [&](int level, const LeafCoordinates& leaf) {
                return above[static_cast<std::size_t>(level)].find(leaf) != no_leaf || is_stale(level, leaf);
              },
              [&](const EntryCells& cells) {
                if (is_stale(cells.level, cells.leaf)) cells_->certifier.certify_entry(cells, part);
              });
        return part;
      },
      combine);
  places_.insert(places_.end(), found.places.begin(), found.places.end());
}

}  // namespace bespoke
