#include "bespoke/bake/sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <sstream>

#include "bespoke/error.h"
#include "bespoke/lattice/leaf_table.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

// Enough points for a call to keep all threads busy, few enough to stay in the caches.
constexpr std::size_t leaves_per_call = 128;
constexpr std::size_t points_per_call = leaves_per_call * leaf_nodes;

void put_nodes(const Lattice& lattice, const LeafCoordinates& leaf, double* nodes) {
  for (int i = 0; i < leaf_edge; ++i)
    for (int j = 0; j < leaf_edge; ++j)
      for (int k = 0; k < leaf_edge; ++k) {
        const std::array<int, 3> local = {i, j, k};
        for (int axis = 0; axis < 3; ++axis)
          *nodes++ = lattice.origin[axis] + lattice.voxel_size * (leaf_edge * leaf[axis] + local[axis]);
      }
}

void sort_unique(std::vector<FinestCell>& cells) {
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
}

class CellFinder {
 public:
  explicit CellFinder(const Pyramid& pyramid) : pyramid_(pyramid) {
    for (const PyramidLevel& level : pyramid.levels) tables_.emplace_back(level.leaves);
  }

  FinestCell find(const Vector3& x) const {
    FinestCell cell;
    for (cell.level = static_cast<int>(tables_.size()) - 1;; --cell.level) {
      const auto level = static_cast<std::size_t>(cell.level);
      const Vector3 lattice = (x - pyramid_.origin) / pyramid_.levels[level].voxel_size;
      for (int axis = 0; axis < 3; ++axis)
        cell.node[static_cast<std::size_t>(axis)] = static_cast<int>(std::floor(lattice[axis]));
      if (cell.level == 0 ||
          tables_[level].find({cell.node[0] >> 3, cell.node[1] >> 3, cell.node[2] >> 3}) != no_leaf)
        return cell;
    }
  }

 private:
  const Pyramid& pyramid_;
  std::vector<LeafTable> tables_;
};

using Triangle = std::array<Vector3, 3>;

// Halves the longest edge where it exceeds `length`.
void split_if_longer(const Triangle& triangle, double length, std::vector<Triangle>& parts) {
  std::size_t longest = 0;
  double squared = 0;
  for (std::size_t edge = 0; edge < 3; ++edge) {
    const double found = (triangle[(edge + 1) % 3] - triangle[edge]).squaredNorm();
    if (found > squared) longest = edge;
    squared = std::max(squared, found);
  }
  if (!(squared > length * length)) return;
  const Vector3 middle = 0.5 * (triangle[longest] + triangle[(longest + 1) % 3]);
  for (const std::size_t kept : {longest, (longest + 1) % 3}) {
    parts.push_back(triangle);
    parts.back()[kept == longest ? (longest + 1) % 3 : longest] = middle;
  }
}

[[noreturn]] void refuse_point(const Points& x, const Points& u) {
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    if (!u.col(i).allFinite()) {
      std::ostringstream message;
      message << "the map is not finite at (" << x.col(i).transpose() << ")";
      throw InvalidInput(message.str());
    }
  throw InvalidInput("the map exceeds the range of float");
}

}  // namespace

std::vector<float> sample_leaves(const ElasticMap& map, const Lattice& lattice,
                                 const std::vector<LeafCoordinates>& leaves, const Progress& progress) {
  std::vector<float> sampled(3 * leaf_nodes * leaves.size());
  Points x;
  for (std::size_t first = 0; first < leaves.size(); first += leaves_per_call) {
    progress.step("bake", first, leaves.size());
    const std::size_t count = std::min(leaves_per_call, leaves.size() - first);
    x.resize(3, static_cast<Eigen::Index>(count * leaf_nodes));
    for (std::size_t i = 0; i < count; ++i)
      put_nodes(lattice, leaves[first + i], x.data() + 3 * leaf_nodes * i);
    const Points u = map.displacement(x);
    Eigen::Map<Eigen::Matrix3Xf> values(&sampled[3 * leaf_nodes * first], 3, u.cols());
    values = u.cast<float>();
    if (!values.allFinite()) refuse_point(x, u);
  }
  progress.step("bake", leaves.size(), leaves.size());
  return sampled;
}

PyramidLevel sample_level(const ElasticMap& map, const Lattice& lattice,
                          const std::vector<LeafCoordinates>& leaves, const Progress& progress) {
  PyramidLevel level{lattice.voxel_size, leaves, sample_leaves(map, lattice, leaves, progress)};
  keep_leaves(level, [](const LeafCoordinates&, bool zero) { return !zero; });
  return level;
}

void keep_leaves(PyramidLevel& level,
                 const std::function<bool(const LeafCoordinates& leaf, bool zero)>& keep) {
  std::size_t kept = 0;
  for (std::size_t leaf = 0; leaf < level.leaves.size(); ++leaf) {
    const auto values = level.values.begin() + static_cast<std::ptrdiff_t>(3 * leaf_nodes * leaf);
    const bool zero = std::all_of(values, values + 3 * leaf_nodes, [](float value) { return value == 0; });
    if (!keep(level.leaves[leaf], zero)) continue;
    level.leaves[kept] = level.leaves[leaf];
    std::copy(values, values + 3 * leaf_nodes,
              level.values.begin() + static_cast<std::ptrdiff_t>(3 * leaf_nodes * kept));
    ++kept;
  }
  level.leaves.resize(kept);
  level.values.resize(3 * leaf_nodes * kept);
}

Points random_points(const Lattice& lattice, const std::vector<LeafCoordinates>& leaves, std::size_t count,
                     std::uint64_t seed) {
  if (leaves.empty()) return Points(3, 0);
  std::mt19937_64 engine(seed);
  const auto fraction = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  Points x(3, static_cast<Eigen::Index>(count));
  for (std::size_t i = 0; i < count; ++i) {
    const LeafCoordinates& leaf = leaves[static_cast<std::size_t>(
        static_cast<double>(i) / static_cast<double>(count) * static_cast<double>(leaves.size()))];
    for (int axis = 0; axis < 3; ++axis)
      x(axis, static_cast<Eigen::Index>(i)) =
          lattice.origin[axis] + lattice.voxel_size * leaf_edge * (leaf[axis] + fraction());
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
  const auto faces = static_cast<std::size_t>(surface.faces.cols());
  constexpr std::size_t grain = 1024;
  std::vector<std::vector<FinestCell>> found((faces + grain - 1) / grain);
  parallel_for(faces, grain, [&](std::size_t begin, std::size_t end) {
    std::vector<FinestCell>& cells = found[begin / grain];
    std::vector<Triangle> parts;
    for (std::size_t face = begin; face < end; ++face) {
      const auto corner = [&](int n) {
        return Vector3(surface.vertices.col(surface.faces(n, static_cast<Eigen::Index>(face))));
      };
      parts.push_back({corner(0), corner(1), corner(2)});
      while (!parts.empty()) {
        const Triangle part = parts.back();
        parts.pop_back();
        double finest = std::numeric_limits<double>::infinity();
        for (const Vector3& place : part) {
          cells.push_back(finder.find(place));
          finest = std::min(finest, pyramid.levels[static_cast<std::size_t>(cells.back().level)].voxel_size);
        }
        split_if_longer(part, finest, parts);
      }
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
  const std::size_t drawn = std::min(cells.size(), count / 27);
  std::mt19937_64 engine(seed);
  const auto fraction = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  // Another seed draws other cells.
  const std::size_t start = engine() % std::max<std::size_t>(cells.size(), 1);
  Points x(3, static_cast<Eigen::Index>(27 * drawn));
  for (std::size_t i = 0; i < drawn; ++i) {
    const FinestCell& cell = cells[(i * cells.size() + start) / drawn];
    for (int part = 0; part < 27; ++part) {
      const Vector3 place(part / 9 + fraction(), part / 3 % 3 + fraction(), part % 3 + fraction());
      x.col(static_cast<Eigen::Index>(27 * i) + part) =
          pyramid.origin + pyramid.levels[static_cast<std::size_t>(cell.level)].voxel_size *
                               (Vector3(cell.node[0], cell.node[1], cell.node[2]) + place / 3);
    }
  }
  return x;
}

std::vector<double> displacement_errors(const ElasticMap& baked, const ElasticMap& exact, const Points& x,
                                        const Progress& progress) {
  std::vector<double> errors(static_cast<std::size_t>(x.cols()));
  for (std::size_t first = 0; first < errors.size(); first += points_per_call) {
    progress.step("measure", first, errors.size());
    const auto count = static_cast<Eigen::Index>(std::min(points_per_call, errors.size() - first));
    const Points part = x.middleCols(static_cast<Eigen::Index>(first), count);
    const Points difference = baked.displacement(part) - exact.displacement(part);
    for (Eigen::Index i = 0; i < count; ++i)
      errors[first + static_cast<std::size_t>(i)] = difference.col(i).norm();
  }
  progress.step("measure", errors.size(), errors.size());
  return errors;
}

}  // namespace bespoke
