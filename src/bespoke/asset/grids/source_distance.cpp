#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>

#include <algorithm>

#include "bespoke/asset/grids/grid_conversion.h"
#include "bespoke/asset/grids/preview.h"
#include "bespoke/asset/grids/vdb_leaves.h"
#include "bespoke/error.h"

namespace bespoke {
namespace {

constexpr double voxels_along_diagonal = 128;

// Half the width of a narrow band, as level-set tools expect it.
constexpr float band_voxels = 3;

/// The mesh in index space, as OpenVDB's converter requires it.
struct IndexSpaceMesh {
  const TriangleMesh& mesh;
  Vector3 origin;
  double voxel_size;

  std::size_t polygonCount() const { return static_cast<std::size_t>(mesh.faces.cols()); }
  std::size_t pointCount() const { return static_cast<std::size_t>(mesh.vertices.cols()); }
  std::size_t vertexCount(std::size_t) const { return 3; }
  void getIndexSpacePoint(std::size_t face, std::size_t corner, openvdb::Vec3d& point) const {
    const int vertex = mesh.faces(static_cast<Eigen::Index>(corner), static_cast<Eigen::Index>(face));
    const Vector3 x = (mesh.vertices.col(vertex) - origin) / voxel_size;
    point = openvdb::Vec3d(x.x(), x.y(), x.z());
  }
};

void copy_leaves(const openvdb::FloatTree& tree, StoredGrid& grid) {
  for (const auto& [coordinates, leaf] : sorted_leaves(tree)) {
    grid.leaves.push_back(coordinates);
    grid.active.push_back(active_mask(*leaf));
    grid.values.insert(grid.values.end(), leaf->buffer().data(), leaf->buffer().data() + leaf_nodes);
  }
}

}  // namespace

StoredGrid source_distance_preview(const TriangleMesh& source) {
  initialize_vdb();
  StoredGrid grid;
  grid.name = source_distance_name;
  grid.components = 1;
  grid.grid_class = GridClass::level_set;
  grid.voxel_size = diagonal(source.vertices) / voxels_along_diagonal;
  grid.origin = bounding_box(source.vertices).min();

  const IndexSpaceMesh mesh{source, grid.origin, grid.voxel_size};
  // Distances in voxels: OpenVDB refuses transforms of small voxel sizes.
  const auto transform = openvdb::math::Transform::createLinearTransform(1);
  const bool closed = inspect_mesh(source).boundary_edges == 0;
  const auto voxel = static_cast<float>(grid.voxel_size);
  grid.background = band_voxels * voxel;
  if (closed) {
    copy_leaves(
        openvdb::tools::meshToVolume<openvdb::FloatGrid>(mesh, *transform, band_voxels, band_voxels)->tree(),
        grid);
  } else {
    // The sign of an open mesh is a guess: the shell around it is not.
    copy_leaves(
        openvdb::tools::meshToVolume<openvdb::FloatGrid>(mesh, *transform, band_voxels + 1, band_voxels + 1,
                                                         openvdb::tools::UNSIGNED_DISTANCE_FIELD)
            ->tree(),
        grid);
    for (float& value : grid.values) value = std::min(value - 1, band_voxels);
  }
  for (float& value : grid.values) value *= voxel;
  grid.metadata["bespoke:meaning"] =
      std::string(closed ? "signed distance to the source model"
                         : "unsigned distance to the source model, which is open, minus one voxel: a shell");
  return grid;
}

}  // namespace bespoke
