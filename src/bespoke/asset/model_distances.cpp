#include "bespoke/asset/model_distances.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <optional>

#include "bespoke/asset/grids/distance_band.h"
#include "bespoke/asset/grids/preview.h"
#include "bespoke/error.h"
#include "bespoke/instruction_set.h"
#include "bespoke/lattice/lattice.h"
#include "bespoke/lattice/leaf_table.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

constexpr std::size_t points_per_range = 512;

// Voxels from the surface up to which cubic weights count alone, and from which trilinear ones do: beyond,
// the cubic stencil of two nodes to each side leaves the band of three.
constexpr double all_cubic = 1, all_trilinear = 2;

// Keys's kernel (a = -1/2) at the four nodes around a place between the second and the third.
[[gnu::always_inline]] inline std::array<double, 4> cubic_weights(double f) {
  return {f * (-0.5 + f * (1 - 0.5 * f)), 1 + f * f * (-2.5 + 1.5 * f), f * (0.5 + f * (2 - 1.5 * f)),
          f * f * (-0.5 + 0.5 * f)};
}

// A leaf with the nodes that stencils of its cells reach beyond it: one below it, two above.
constexpr int brick_edge = leaf_edge + 3;
constexpr int brick_nodes = brick_edge * brick_edge * brick_edge;

using FloatLanes = float __attribute__((vector_size(4 * sizeof(float))));
using Lanes = double __attribute__((vector_size(4 * sizeof(double))));

/// The nodes around a cell, four along an axis from the one below it; those along y follow each other, so
/// that the rows along z of four of them are summed at once.
struct Stencil {
  const float* first;
  int x_stride, z_stride;

  const float* row(int i, int k) const { return first + i * x_stride + k * z_stride; }
};

}  // namespace

struct DistanceGrid::Data {
  explicit Data(const StoredGrid& grid)
      : lattice{grid.origin, grid.voxel_size},
        background(grid.background),
        leaves(grid.leaves),
        values(grid.values),
        table(grid.leaves),
        error(0),
        inside_leaves(enclosed_leaves(grid)),
        inside(inside_leaves) {
    if (const auto found = grid.metadata.find(distance_error_key); found != grid.metadata.end())
      if (const auto* number = std::get_if<double>(&found->second)) error = *number;
  }

  struct Leaf {
    const float* values = nullptr;  // null: the constant everywhere
    float constant = 0;
  };
  Leaf leaf(const LeafCoordinates& at) const {
    const int stored = table.find(at);
    if (stored != no_leaf) return {values.data() + static_cast<std::size_t>(stored) * leaf_nodes, 0};
    return {nullptr, inside.find(at) == no_leaf ? background : -background};
  }

  /// The nodes from `first` on, `edge` along each axis, in the order of a stencil.
  void gather(const LatticeCoordinates& first, int edge, float* nodes) const {
    LeafCoordinates at = leaf_of(first);
    Leaf in = leaf(at);
    for (int i = 0; i < edge; ++i)
      for (int k = 0; k < edge; ++k)
        for (int j = 0; j < edge; ++j) {
          const LatticeCoordinates node = moved(first, {i, j, k});
          if (const LeafCoordinates next = leaf_of(node); next != at) in = leaf(at = next);
          *nodes++ = in.values ? in.values[number_of_place(place_in_leaf(node))] : in.constant;
        }
  }

  /// Made by the first look-up, since most maps are opened for other ends.
  const std::vector<float>& bricks() const {
    std::call_once(bricks_made, [&] {
      bricks_.resize(leaves.size() * brick_nodes);
      // Not in parallel: a thread that waited for others in here might come to look up the same grid.
      for (std::size_t i = 0; i < leaves.size(); ++i)
        gather(moved(first_node(leaves[i]), {-1, -1, -1}), brick_edge, bricks_.data() + i * brick_nodes);
    });
    return bricks_;
  }

  /// Where a place is: in the cell of a stencil, from its lower node in voxels.
  struct Place {
    Stencil nodes;
    Vector3 f;
  };
  /// What look-ups of places near each other have in common: the last leaf, and nodes of cells whose
  /// leaf is not stored.
  struct Last {
    LeafCoordinates leaf{std::numeric_limits<int>::min(), 0, 0};
    int stored = no_leaf;
    std::array<float, 64> own;
  };
  /// Empty far outside of all lattices.
  [[gnu::always_inline]] std::optional<Place> place_of(const Vector3& x, const float* of_bricks,
                                                       Last& last) const {
    const Vector3 place = (x - lattice.origin) / lattice.voxel_size;
    if (!(place.cwiseAbs().maxCoeff() < 1 << 28)) return std::nullopt;
    const Vector3 low = place.array().floor();
    const LatticeCoordinates cell{static_cast<int>(low[0]), static_cast<int>(low[1]),
                                  static_cast<int>(low[2])};
    const LeafCoordinates leaf = leaf_of(cell);
    if (leaf[0] != last.leaf[0] || leaf[1] != last.leaf[1] || leaf[2] != last.leaf[2]) {
      last.leaf = leaf;
      last.stored = table.find(leaf);
    }
    if (last.stored != no_leaf) {
      const LatticeCoordinates at = place_in_leaf(cell);
      return Place{{of_bricks + static_cast<std::size_t>(last.stored) * brick_nodes +
                        (at[0] * brick_edge + at[2]) * brick_edge + at[1],
                    brick_edge * brick_edge, brick_edge},
                   place - low};
    }
    gather(moved(cell, {-1, -1, -1}), 4, last.own.data());
    return Place{{last.own.data(), 16, 4}, place - low};
  }

  [[gnu::always_inline]] static double trilinear(const Place& at) {
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const LatticeCoordinates step = corner_step(corner);
      double weight = 1;
      for (int axis = 0; axis < 3; ++axis)
        weight *= step[static_cast<std::size_t>(axis)] ? at.f[axis] : 1 - at.f[axis];
      sum += weight * static_cast<double>(at.nodes.row(step[0] + 1, step[2] + 1)[step[1] + 1]);
    }
    return sum;
  }

  [[gnu::always_inline]] static double cubic_at(const Place& at) {
    const std::array<double, 4> x = cubic_weights(at.f[0]), y = cubic_weights(at.f[1]),
                                z = cubic_weights(at.f[2]);
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      Lanes rows{};
      for (std::size_t k = 0; k < 4; ++k) {
        FloatLanes row;
        std::memcpy(&row, at.nodes.row(static_cast<int>(i), static_cast<int>(k)), sizeof row);
        rows += z[k] * __builtin_convertvector(row, Lanes);
      }
      for (std::size_t j = 0; j < 4; ++j) sum += x[i] * y[j] * rows[j];
    }
    return sum;
  }

  /// How much of the cubic value counts.
  [[gnu::always_inline]] double cubic_share(double trilinear) const {
    const double voxels = std::abs(trilinear) / lattice.voxel_size;
    return std::clamp((all_trilinear - voxels) / (all_trilinear - all_cubic), 0.0, 1.0);
  }

  /// Of a range of columns of x, into `found`.
  struct LookUp {
    [[gnu::always_inline]] static void run(const Data& data, const Points& x, std::size_t begin,
                                           std::size_t end, UncertainDistances& found) {
      Last last;
      const float* of_bricks = data.bricks().data();
      for (std::size_t i = begin; i < end; ++i) {
        const auto at = data.place_of(x.col(static_cast<Eigen::Index>(i)), of_bricks, last);
        found.distance[i] = data.background;
        found.uncertainty[i] = 0;
        if (!at) continue;
        const double linear = trilinear(*at), share = data.cubic_share(linear);
        found.distance[i] = linear;
        // Far outside nobody needs to know it.
        if (!(share > 0 || linear < 0)) continue;
        const double cubic = cubic_at(*at);
        found.uncertainty[i] = std::abs(cubic - linear);
        if (share > 0) found.distance[i] = share * cubic + (1 - share) * linear;
      }
    }
  };

  Lattice lattice;
  float background;
  std::vector<LeafCoordinates> leaves;
  std::vector<float> values;
  LeafTable table;
  double error;
  std::vector<LeafCoordinates> inside_leaves;
  LeafTable inside;

 private:
  mutable std::once_flag bricks_made;
  mutable std::vector<float> bricks_;  // brick_nodes a leaf
};

double DistanceGrid::band() const { return data_->background; }
double DistanceGrid::voxel_size() const { return data_->lattice.voxel_size; }
double DistanceGrid::error() const { return data_->error; }

std::vector<double> DistanceGrid::operator()(const Points& x) const {
  return std::move(with_uncertainty(x).distance);
}

UncertainDistances DistanceGrid::with_uncertainty(const Points& x) const {
  const auto count = static_cast<std::size_t>(x.cols());
  UncertainDistances found{std::vector<double>(count), std::vector<double>(count)};
  parallel_for(count, points_per_range, [&](std::size_t begin, std::size_t end) {
    run_dispatched<Data::LookUp>(*data_, x, begin, end, found);
  });
  return found;
}

bool operator==(const DistanceGrid& a, const DistanceGrid& b) {
  const DistanceGrid::Data &one = *a.data_, &other = *b.data_;
  return &one == &other ||
         (one.lattice.origin == other.lattice.origin && one.lattice.voxel_size == other.lattice.voxel_size &&
          one.background == other.background && one.leaves == other.leaves && one.values == other.values);
}

/// Makes look-ups of stored grids.
class StoredDistances {
 public:
  static DistanceGrid lookup(const StoredGrid& grid) {
    return DistanceGrid(std::make_shared<const DistanceGrid::Data>(grid));
  }
};

namespace {

const StoredGrid* grid_named(const Asset& asset, const char* name) {
  if (!asset.preview) return nullptr;
  for (const StoredGrid& grid : asset.preview->grids())
    if (grid.name == name) return &grid;
  return nullptr;
}

/// That of the target, or of the source: its preview where that has sides, else its own.
const StoredGrid* sided_grid(const Asset& asset, bool of_target) {
  const StoredGrid* target = grid_named(asset, target_distance_name);
  if (of_target || !target) return target;
  const StoredGrid* own = grid_named(asset, source_side_name);
  return own ? own : grid_named(asset, source_distance_name);
}

StoredGrid measured(StoredGrid grid, const TriangleMesh& mesh) {
  const DistanceGrid lookup = StoredDistances::lookup(grid);
  std::vector<double> amounts = lookup(surface_probes(mesh));
  for (double& amount : amounts) amount = std::abs(amount);
  const Statistics error = summarize(std::move(amounts));
  grid.metadata[distance_error_key] = error.p99;
  grid.metadata["bespoke:error_max"] = error.max;
  return grid;
}

StoredGrid made(const SidedModel& model, const char* name, const char* meaning) {
  StoredGrid grid = measured(signed_band(model.mesh, model.distance), model.mesh);
  grid.name = name;
  grid.metadata["bespoke:meaning"] = std::string(meaning);
  return grid;
}

constexpr const char* target_meaning = "signed distance to the target model, target frame";
constexpr const char* source_meaning =
    "signed distance to the source model, which is open: the side by its winding number and normals";

Asset with_grids_of(Asset asset, std::vector<StoredGrid> further) {
  std::vector<StoredGrid> grids = asset.preview->grids();
  grids.resize(PreviewGrids::required);
  for (StoredGrid& grid : further) grids.push_back(std::move(grid));
  asset.preview = std::make_shared<PreviewGrids>(std::move(grids));
  return asset;
}

}  // namespace

Asset with_model_distances(Asset asset, const SidedModel& source, const SidedModel& target) {
  if (!asset.preview) throw InvalidInput("the asset has no preview grids; with_preview adds them");
  std::vector<StoredGrid> further;
  further.push_back(made(target, target_distance_name, target_meaning));
  if (inspect_mesh(source.mesh).boundary_edges > 0)
    further.push_back(made(source, source_side_name, source_meaning));
  return with_grids_of(std::move(asset), std::move(further));
}

Asset with_model_distances_of(Asset asset, const Asset& source_of, const Asset& target_of, bool turned) {
  const StoredGrid* source = sided_grid(source_of, turned);
  const StoredGrid* target = sided_grid(target_of, !turned);
  if (!asset.preview || !source || !target) return asset;
  std::vector<StoredGrid> further = {*target, *source};
  further[0].name = target_distance_name;
  further[0].metadata["bespoke:meaning"] = std::string(target_meaning);
  further[1].name = source_side_name;
  return with_grids_of(std::move(asset), std::move(further));
}

std::shared_ptr<const ModelDistances> model_distances(const Asset& asset) {
  const StoredGrid* source = sided_grid(asset, false);
  const StoredGrid* target = sided_grid(asset, true);
  if (!source || !target) return nullptr;
  return std::make_shared<const ModelDistances>(
      ModelDistances{StoredDistances::lookup(*source), StoredDistances::lookup(*target)});
}

}  // namespace bespoke
