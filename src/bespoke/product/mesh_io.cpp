#include "bespoke/product/mesh_io.h"

#include "bespoke/product/posed_product.h"

namespace bespoke {

TriangleMesh read_triangle_mesh(const std::filesystem::path& path) {
  const Product product = read_model(path, ModelPose::shown);
  return {product.vertices, triangulated(product)};
}

void write_triangle_mesh(const std::filesystem::path& path, const TriangleMesh& mesh,
                         const std::string& unit) {
  Product product;
  product.unit = unit;
  product.vertices = mesh.vertices;
  product.corners.assign(mesh.faces.data(), mesh.faces.data() + mesh.faces.size());
  product.polygon_start.reserve(static_cast<std::size_t>(mesh.faces.cols()) + 1);
  for (int start = 0; start <= mesh.faces.size(); start += 3) product.polygon_start.push_back(start);
  write_product(path, product);
}

}  // namespace bespoke
