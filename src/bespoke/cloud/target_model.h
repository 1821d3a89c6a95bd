#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "bespoke/cloud/point_cloud_surface.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/product/model_pose.h"
#include "bespoke/product/product_io.h"

namespace bespoke {

/// A model that maps lead to: a mesh, or the surface through a point cloud.
struct TargetModel {
  TriangleMesh mesh;
  std::optional<PointCloudSummary> cloud;  ///< what the mesh was made of, unless it was read
  DegenerateFaces left_out;                ///< of the file
};

/// A model that maps lead from.
struct SourceModel {
  TriangleMesh mesh;
  DegenerateFaces left_out;  ///< of the file
};

/// Reads a mesh as read_triangle_mesh; or a PLY file of points with normals and no faces, whose surface it
/// makes. Throws as these, and InvalidInput where there are points but no normals.
TargetModel read_target(const std::filesystem::path& path, ModelPose pose = ModelPose::shown);

/// Reads a mesh as read_triangle_mesh. Throws InvalidInput for a point cloud with normals: clouds are targets
/// only.
SourceModel read_source_model(const std::filesystem::path& path, ModelPose pose = ModelPose::shown);
TriangleMesh read_source(const std::filesystem::path& path);

/// A model that a map was made of: as read above or, unless that has the hash of the map's record, in the
/// pose that is stored, if that has the hash, and in the map's unit where the file says another one
/// (format_unit.h).
TargetModel read_target(const std::filesystem::path& path, const std::string& unit, const std::string& hash);
TriangleMesh read_source(const std::filesystem::path& path, const std::string& unit, const std::string& hash);

/// Of the cloud, or else of the mesh: names the file's content in an asset.
std::string content_hash(const TargetModel& target);

}  // namespace bespoke
