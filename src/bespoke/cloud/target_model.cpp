#include "bespoke/cloud/target_model.h"

#include <utility>

#include "bespoke/error.h"
#include "bespoke/product/format_unit.h"
#include "bespoke/product/product_io.h"

namespace bespoke {

TargetModel read_target(const std::filesystem::path& path) {
  Product product = read_product(path);
  require_no_degenerate_faces(product);
  if (!product.corners.empty()) return {{product.vertices, triangulated(product)}, std::nullopt};
  if (product.normals.cols() == 0)
    throw InvalidInput(path.string() +
                       " has no faces, and its points have no normals; a point cloud as target is a PLY file "
                       "whose vertices have the properties nx, ny and nz beside x, y and z");
  PointCloudSurface made = point_cloud_surface({product.vertices, product.normals}, path.string());
  return {std::move(made.mesh), std::move(made.summary)};
}

TriangleMesh read_source(const std::filesystem::path& path) {
  const Product product = read_product(path);
  require_no_degenerate_faces(product);
  if (product.normals.cols() > 0)
    throw InvalidInput(path.string() +
                       ": is a point cloud, which can be a target only: a map is carried by the faces of its "
                       "source; mesh it, or fit the other model onto it");
  return {product.vertices, triangulated(product)};
}

TargetModel read_target(const std::filesystem::path& path, const std::string& unit, const std::string& hash) {
  TargetModel target = read_target(path);
  const double scale = scale_to_unit(path, unit);
  if (scale != 1 && content_hash(target) != hash) target.mesh.vertices *= scale;
  return target;
}

TriangleMesh read_source(const std::filesystem::path& path, const std::string& unit,
                         const std::string& hash) {
  TriangleMesh source = read_source(path);
  const double scale = scale_to_unit(path, unit);
  if (scale != 1 && content_hash(source) != hash) source.vertices *= scale;
  return source;
}

std::string content_hash(const TargetModel& target) {
  return target.cloud ? target.cloud->hash : content_hash(target.mesh);
}

}  // namespace bespoke
