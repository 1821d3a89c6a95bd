#include "bespoke/bake/pyramid/leaf_samples.h"

#include <algorithm>
#include <sstream>

#include "bespoke/error.h"

namespace bespoke {
namespace {

// Enough points for a call to keep all threads busy, few enough to stay in the caches.
constexpr std::size_t leaves_per_call = 128;

void put_nodes(const Lattice& lattice, const LeafCoordinates& leaf, Points& x, Eigen::Index first) {
  for (int node = 0; node < leaf_nodes; ++node)
    x.col(first + node) = lattice(moved(first_node(leaf), place_of_number(node)));
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
  std::vector<float> sampled(leaf_floats * leaves.size());
  Points x;
  for (std::size_t first = 0; first < leaves.size(); first += leaves_per_call) {
    progress.step("bake", first, leaves.size());
    const std::size_t count = std::min(leaves_per_call, leaves.size() - first);
    x.resize(3, static_cast<Eigen::Index>(count * leaf_nodes));
    for (std::size_t i = 0; i < count; ++i)
      put_nodes(lattice, leaves[first + i], x, static_cast<Eigen::Index>(leaf_nodes * i));
    const Points u = map.displacement(x);
    Eigen::Map<Eigen::Matrix3Xf> values(&sampled[leaf_floats * first], 3, u.cols());
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
    const float* values = level.values_of(leaf);
    const bool zero = std::all_of(values, values + leaf_floats, [](float value) { return value == 0; });
    if (!keep(level.leaves[leaf], zero)) continue;
    level.leaves[kept] = level.leaves[leaf];
    std::copy(values, values + leaf_floats, level.values_of(kept));
    ++kept;
  }
  level.leaves.resize(kept);
  level.values.resize(leaf_floats * kept);
}

}  // namespace bespoke
