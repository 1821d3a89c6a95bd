#include "bespoke/asset/model_distances.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "bespoke/asset/grids/distance_band.h"
#include "bespoke/asset/grids/preview.h"
#include "bespoke/error.h"
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
std::array<double, 4> cubic_weights(double f) {
  return {f * (-0.5 + f * (1 - 0.5 * f)), 1 + f * f * (-2.5 + 1.5 * f), f * (0.5 + f * (2 - 1.5 * f)),
          f * f * (-0.5 + 0.5 * f)};
}

}  // namespace

struct DistanceGrid::Data {
  explicit Data(const StoredGrid& grid)
      : lattice{grid.origin, grid.voxel_size},
        background(grid.background),
        values(grid.values),
        table(grid.leaves),
        error(0),
        inside_leaves(enclosed_leaves(grid)),
        inside(inside_leaves) {
    if (const auto found = grid.metadata.find(distance_error_key); found != grid.metadata.end())
      if (const auto* number = std::get_if<double>(&found->second)) error = *number;
  }

  /// The nodes around a cell, two to each side along every axis.
  using Stencil = std::array<float, 64>;
  Stencil stencil(const LatticeCoordinates& cell) const {
    // Along an axis they lie in two leaves at most, so eight are looked up, not 64.
    std::array<std::array<int, 4>, 3> leaf_side{}, place{};
    LeafCoordinates low{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = (cell[axis] - 1) >> 3;
      for (int n = 0; n < 4; ++n) {
        const int node = cell[axis] - 1 + n;
        leaf_side[axis][static_cast<std::size_t>(n)] = (node >> 3) - low[axis];
        place[axis][static_cast<std::size_t>(n)] = node & 7;
      }
    }
    std::array<Leaf, 8> leaves;
    for (int corner = 0; corner < 8; ++corner) {
      const LatticeCoordinates step = corner_step(corner);
      if (step[0] <= leaf_side[0][3] && step[1] <= leaf_side[1][3] && step[2] <= leaf_side[2][3])
        leaves[static_cast<std::size_t>(corner)] = leaf(moved(low, step));
    }
    Stencil nodes;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j)
        for (std::size_t k = 0; k < 4; ++k) {
          const Leaf& in =
              leaves[static_cast<std::size_t>(4 * leaf_side[0][i] + 2 * leaf_side[1][j] + leaf_side[2][k])];
          nodes[16 * i + 4 * j + k] =
              in.values ? in.values[number_of_place({place[0][i], place[1][j], place[2][k]})] : in.constant;
        }
    return nodes;
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

  /// Both interpolations of a distance.
  struct Interpolated {
    double trilinear = 0, cubic = 0;
  };
  Interpolated at(const Vector3& x) const {
    const Vector3 place = (x - lattice.origin) / lattice.voxel_size;
    if (!(place.cwiseAbs().maxCoeff() < 1 << 28)) return {background, background};
    const LatticeCoordinates cell = lattice.cell_of(x);
    const Vector3 f = place - as_vector(cell);
    const Stencil nodes = stencil(cell);
    Interpolated found;
    const std::array<std::array<double, 4>, 3> w = {cubic_weights(f[0]), cubic_weights(f[1]),
                                                    cubic_weights(f[2])};
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j) {
        double row = 0;
        for (std::size_t k = 0; k < 4; ++k) row += w[2][k] * static_cast<double>(nodes[16 * i + 4 * j + k]);
        found.cubic += w[0][i] * w[1][j] * row;
      }
    for (int corner = 0; corner < 8; ++corner) {
      const LatticeCoordinates step = corner_step(corner);
      double weight = 1;
      for (int axis = 0; axis < 3; ++axis)
        weight *= step[static_cast<std::size_t>(axis)] ? f[axis] : 1 - f[axis];
      found.trilinear +=
          weight * static_cast<double>(
                       nodes[static_cast<std::size_t>(16 * (step[0] + 1) + 4 * (step[1] + 1) + step[2] + 1)]);
    }
    return found;
  }

  /// How much of the cubic one counts.
  double cubic_share(const Interpolated& found) const {
    const double voxels = std::abs(found.trilinear) / lattice.voxel_size;
    return std::clamp((all_trilinear - voxels) / (all_trilinear - all_cubic), 0.0, 1.0);
  }

  Lattice lattice;
  float background;
  std::vector<float> values;
  LeafTable table;
  double error;
  std::vector<LeafCoordinates> inside_leaves;
  LeafTable inside;
};

double DistanceGrid::band() const { return data_->background; }
double DistanceGrid::voxel_size() const { return data_->lattice.voxel_size; }
double DistanceGrid::error() const { return data_->error; }

std::vector<double> DistanceGrid::operator()(const Points& x) const {
  std::vector<double> distances(static_cast<std::size_t>(x.cols()));
  parallel_for(distances.size(), points_per_range, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Data::Interpolated found = data_->at(x.col(static_cast<Eigen::Index>(i)));
      const double share = data_->cubic_share(found);
      distances[i] = share * found.cubic + (1 - share) * found.trilinear;
    }
  });
  return distances;
}

std::vector<double> DistanceGrid::uncertainty(const Points& x) const {
  std::vector<double> amounts(static_cast<std::size_t>(x.cols()));
  parallel_for(amounts.size(), points_per_range, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Data::Interpolated found = data_->at(x.col(static_cast<Eigen::Index>(i)));
      amounts[i] = std::abs(found.cubic - found.trilinear);
    }
  });
  return amounts;
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
