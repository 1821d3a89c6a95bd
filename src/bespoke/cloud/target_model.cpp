#include "bespoke/cloud/target_model.h"

#include <utility>

#include "bespoke/error.h"
#include "bespoke/product/format_unit.h"
#include "bespoke/product/posed_product.h"

namespace bespoke {
namespace {

/// The pose of a model whose mesh has this hash, perhaps once it is scaled.
ModelPose pose_of_hash(const std::filesystem::path& path, double scale, const std::string& hash) {
  if (hash.empty() || !has_two_poses(path)) return ModelPose::shown;
  const Product stored = read_model(path, ModelPose::stored);
  const TriangleMesh mesh{stored.vertices, triangulated(stored)};
  const bool is_stored =
      content_hash(mesh) == hash || content_hash(TriangleMesh{scale * mesh.vertices, mesh.faces}) == hash;
  return is_stored ? ModelPose::stored : ModelPose::shown;
}

}  // namespace

TargetModel read_target(const std::filesystem::path& path, ModelPose pose) {
  Product product = read_model(path, pose);
  if (!product.corners.empty())
    return {{product.vertices, triangulated(product)}, std::nullopt, product.degenerate};
  if (product.normals.cols() == 0)
    throw InvalidInput(path.string() +
                       " has no faces, and its points have no normals; a point cloud as target is a PLY file "
                       "whose vertices have the properties nx, ny and nz beside x, y and z");
  PointCloudSurface made = point_cloud_surface({product.vertices, product.normals}, path.string());
  return {std::move(made.mesh), std::move(made.summary), {}};
}

SourceModel read_source_model(const std::filesystem::path& path, ModelPose pose) {
  const Product product = read_model(path, pose);
  if (product.normals.cols() > 0)
    throw InvalidInput(path.string() +
                       ": is a point cloud, which can be a target only: a map is carried by the faces of its "
                       "source; mesh it, or fit the other model onto it");
  return {{product.vertices, triangulated(product)}, product.degenerate};
}

TriangleMesh read_source(const std::filesystem::path& path) { return read_source_model(path).mesh; }

TargetModel read_target(const std::filesystem::path& path, const std::string& unit, const std::string& hash) {
  const double scale = scale_to_unit(path, unit);
  TargetModel target = read_target(path, pose_of_hash(path, scale, hash));
  if (scale != 1 && content_hash(target) != hash) target.mesh.vertices *= scale;
  return target;
}

TriangleMesh read_source(const std::filesystem::path& path, const std::string& unit,
                         const std::string& hash) {
  const double scale = scale_to_unit(path, unit);
  TriangleMesh source = read_source_model(path, pose_of_hash(path, scale, hash)).mesh;
  if (scale != 1 && content_hash(source) != hash) source.vertices *= scale;
  return source;
}

std::string content_hash(const TargetModel& target) {
  return target.cloud ? target.cloud->hash : content_hash(target.mesh);
}

}  // namespace bespoke
