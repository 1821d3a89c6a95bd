#include "bespoke/volume/sampling.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <sstream>

#include "bespoke/error.h"
#include "bespoke/volume/leaf_table.h"

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

Points points_in_cells_at(const Pyramid& pyramid, const Points& at, std::size_t count, std::uint64_t seed) {
  if (pyramid.levels.empty() || at.cols() == 0) return Points(3, 0);
  std::vector<LeafTable> tables;
  for (const PyramidLevel& level : pyramid.levels) tables.emplace_back(level.leaves);
  const auto cells = std::min(static_cast<std::size_t>(at.cols()), count / 27);
  std::mt19937_64 engine(seed);
  const auto fraction = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  Points x(3, static_cast<Eigen::Index>(27 * cells));
  for (std::size_t i = 0; i < cells; ++i) {
    const auto column = static_cast<Eigen::Index>(i * static_cast<std::size_t>(at.cols()) / cells);
    std::size_t level = pyramid.levels.size();
    Vector3 cell = Vector3::Zero();
    bool found = false;
    while (!found && level-- > 0) {
      cell = ((at.col(column) - pyramid.origin) / pyramid.levels[level].voxel_size).array().floor();
      const Eigen::Vector3i leaf = (cell / leaf_edge).array().floor().cast<int>();
      found = tables[level].find({leaf.x(), leaf.y(), leaf.z()}) != no_leaf;
    }
    level = found ? level : 0;
    for (int part = 0; part < 27; ++part) {
      const Vector3 place(part / 9 + fraction(), part / 3 % 3 + fraction(), part % 3 + fraction());
      x.col(static_cast<Eigen::Index>(27 * i) + part) =
          pyramid.origin + pyramid.levels[level].voxel_size * (cell + place / 3);
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
