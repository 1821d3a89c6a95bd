#include "bespoke/bake/error_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "bespoke/lattice/leaf_table.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

// Enough points for a call to keep all threads busy, few enough to stay in the caches.
constexpr std::size_t points_per_call = 1 << 16;

void sort_unique(std::vector<FinestCell>& cells) {
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
}

Vector3 point_of_unit_cube(std::mt19937_64& engine) {
  const auto fraction = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  const double x = fraction(), y = fraction(), z = fraction();
  return {x, y, z};
}

struct Corner {
  Vector3 place;
  FinestCell cell;
  bool in_a_leaf;
  double cell_size;  ///< of a leaf, where there is none
};

class CellFinder {
 public:
  explicit CellFinder(const Pyramid& pyramid) : pyramid_(pyramid) {
    for (const PyramidLevel& level : pyramid.levels) tables_.emplace_back(level.leaves);
  }

  /// Outside all leaves the cell of level 0.
  FinestCell find(const Vector3& x) const {
    // Voxels of a level are halves of those above it: the cells that hold x follow from that of the last.
    const int last = static_cast<int>(tables_.size()) - 1;
    const LatticeCoordinates finest = pyramid_.lattice(last).cell_of(x);
    for (int level = last;; --level) {
      const int above = last - level;
      const LatticeCoordinates node{finest[0] >> above, finest[1] >> above, finest[2] >> above};
      if (level == 0 || tables_[static_cast<std::size_t>(level)].find(leaf_of(node)) != no_leaf)
        return {level, node};
    }
  }

  Corner corner(const Vector3& place) const {
    const FinestCell cell = find(place);
    const bool in_a_leaf = cell.level > 0 || tables_.front().find(leaf_of(cell.node)) != no_leaf;
    const double voxel_size = pyramid_.levels[static_cast<std::size_t>(cell.level)].voxel_size;
    return {place, cell, in_a_leaf, in_a_leaf ? voxel_size : leaf_edge * voxel_size};
  }

 private:
  const Pyramid& pyramid_;
  std::vector<LeafTable> tables_;
};

using Triangle = std::array<Corner, 3>;

/// Adds the cells along a triangle: its longest edge is halved until it is no longer than the finest voxel at
/// its corners, or than a leaf where there is none: a step of fine layers may have leaves in few places.
class CellsAlong {
 public:
  CellsAlong(const CellFinder& finder, std::vector<FinestCell>& cells) : finder_(finder), cells_(cells) {}

  void add(const Triangle& triangle) {
    for (const Corner& corner : triangle) add_cell(corner);
    parts_.push_back(triangle);
    while (!parts_.empty()) {
      const Triangle part = parts_.back();
      parts_.pop_back();
      split_if_longer(part);
    }
  }

 private:
  // Neighbours along the surface mostly share one.
  void add_cell(const Corner& corner) {
    if (corner.in_a_leaf && (cells_.empty() || cells_.back() != corner.cell)) cells_.push_back(corner.cell);
  }

  void split_if_longer(const Triangle& triangle) {
    double finest = std::numeric_limits<double>::infinity();
    for (const Corner& corner : triangle) finest = std::min(finest, corner.cell_size);
    std::size_t longest = 0;
    double squared = 0;
    for (std::size_t edge = 0; edge < 3; ++edge) {
      const double found = (triangle[(edge + 1) % 3].place - triangle[edge].place).squaredNorm();
      if (found > squared) longest = edge;
      squared = std::max(squared, found);
    }
    if (!(squared > finest * finest)) return;
    const std::size_t next = (longest + 1) % 3;
    const Corner middle = finder_.corner(0.5 * (triangle[longest].place + triangle[next].place));
    add_cell(middle);
    for (const std::size_t replaced : {next, longest}) {
      parts_.push_back(triangle);
      parts_.back()[replaced] = middle;
    }
  }

  const CellFinder& finder_;
  std::vector<FinestCell>& cells_;
  std::vector<Triangle> parts_;
};

}  // namespace

Points random_points(const Lattice& lattice, const std::vector<LeafCoordinates>& leaves, std::size_t count,
                     std::uint64_t seed) {
  if (leaves.empty()) return Points(3, 0);
  std::mt19937_64 engine(seed);
  Points x(3, static_cast<Eigen::Index>(count));
  for (std::size_t i = 0; i < count; ++i) {
    const auto leaf = static_cast<std::size_t>(static_cast<double>(i) / static_cast<double>(count) *
                                               static_cast<double>(leaves.size()));
    x.col(static_cast<Eigen::Index>(i)) =
        lattice.at(leaf_edge * (as_vector(leaves[leaf]) + point_of_unit_cube(engine)));
  }
  return x;
}

std::vector<FinestCell> finest_cells_at(const Pyramid& pyramid, const Points& at) {
  if (pyramid.levels.empty()) return {};
  const CellFinder finder(pyramid);
  std::vector<FinestCell> cells;
  for (Eigen::Index i = 0; i < at.cols(); ++i) cells.push_back(finder.find(at.col(i)));
  sort_unique(cells);
  return cells;
}

std::vector<FinestCell> finest_cells_on(const Pyramid& pyramid, const TriangleMesh& surface) {
  if (pyramid.levels.empty()) return {};
  const CellFinder finder(pyramid);
  constexpr std::size_t grain = 1024;
  std::vector<Corner> corners(static_cast<std::size_t>(surface.vertices.cols()));
  parallel_for(corners.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      corners[i] = finder.corner(surface.vertices.col(static_cast<Eigen::Index>(i)));
  });
  const auto faces = static_cast<std::size_t>(surface.faces.cols());
  std::vector<std::vector<FinestCell>> found((faces + grain - 1) / grain);
  parallel_for(faces, grain, [&](std::size_t begin, std::size_t end) {
    std::vector<FinestCell>& cells = found[begin / grain];
    CellsAlong along(finder, cells);
    for (std::size_t face = begin; face < end; ++face) {
      const auto corner = [&](int n) {
        return corners[static_cast<std::size_t>(surface.faces(n, static_cast<Eigen::Index>(face)))];
      };
      along.add({corner(0), corner(1), corner(2)});
    }
    sort_unique(cells);
  });
  std::vector<FinestCell> cells;
  for (const auto& part : found) cells.insert(cells.end(), part.begin(), part.end());
  sort_unique(cells);
  return cells;
}

Points points_in_cells(const Pyramid& pyramid, const std::vector<FinestCell>& cells, std::size_t count,
                       std::uint64_t seed) {
  constexpr std::size_t parts = 27;
  if (cells.empty() || count == 0) return Points(3, 0);
  const std::size_t drawn = std::min(cells.size(), count);
  const std::size_t share = std::min(count / drawn, parts);
  std::mt19937_64 engine(seed);
  // Another seed draws other cells, and other parts of them.
  const std::size_t start = engine() % cells.size();
  Points x(3, static_cast<Eigen::Index>(share * drawn));
  Eigen::Index column = 0;
  for (std::size_t i = 0; i < drawn; ++i) {
    const FinestCell& cell = cells[(i * cells.size() + start) / drawn];
    const std::size_t first_part = engine() % parts;
    for (std::size_t n = 0; n < share; ++n) {
      const std::size_t part = (first_part + n * parts / share) % parts;
      const Vector3 third(static_cast<double>(part / 9), static_cast<double>(part / 3 % 3),
                          static_cast<double>(part % 3));
      x.col(column++) =
          pyramid.lattice(cell.level).at(as_vector(cell.node) + (third + point_of_unit_cube(engine)) / 3);
    }
  }
  return x;
}

std::vector<double> displacement_errors(const ElasticMap& baked, const ElasticMap& exact, const Points& x,
                                        const Progress& progress, const ElasticMap* downstream_map) {
  std::vector<double> errors(static_cast<std::size_t>(x.cols()));
  for (std::size_t first = 0; first < errors.size(); first += points_per_call) {
    progress.step("measure", first, errors.size());
    const auto count = static_cast<Eigen::Index>(std::min(points_per_call, errors.size() - first));
    const Points part = x.middleCols(static_cast<Eigen::Index>(first), count);
    const Points difference = downstream_map
                                  ? Points((*downstream_map)(baked(part)) - (*downstream_map)(exact(part)))
                                  : Points(baked.displacement(part) - exact.displacement(part));
    for (Eigen::Index i = 0; i < count; ++i)
      errors[first + static_cast<std::size_t>(i)] = difference.col(i).norm();
  }
  progress.step("measure", errors.size(), errors.size());
  return errors;
}

}  // namespace bespoke
