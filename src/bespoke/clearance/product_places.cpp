#include "bespoke/clearance/product_places.h"

#include <bit>

#include "bespoke/mesh/equal_positions.h"

namespace bespoke {
namespace {

TriangleMesh joined(TriangleMesh mesh, const std::vector<int>& first) {
  for (int& vertex : mesh.faces.reshaped()) vertex = first[static_cast<std::size_t>(vertex)];
  return mesh;
}

}  // namespace

std::size_t ProductPlaces::KeyHash::operator()(const Key& key) const {
  std::uint64_t hash = 0;
  for (const std::uint64_t bits : key) {
    hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 32;
  }
  return static_cast<std::size_t>(hash);
}

ProductPlaces::Key ProductPlaces::key_of(const Vector3& x) {
  return {std::bit_cast<std::uint64_t>(x[0] + 0.0), std::bit_cast<std::uint64_t>(x[1] + 0.0),
          std::bit_cast<std::uint64_t>(x[2] + 0.0)};
}

ProductPlaces::ProductPlaces(const TriangleMesh& product)
    : first_(first_at_equal_position(product.vertices)), around_(vertex_adjacency(joined(product, first_))) {
  for (Eigen::Index v = 0; v < product.vertices.cols(); ++v) at_.emplace(key_of(product.vertices.col(v)), v);
  if (product.faces.cols() > 0) tree_.emplace(product);
}

std::optional<Eigen::Index> ProductPlaces::vertex_at(const Vector3& x) const {
  const auto found = at_.find(key_of(x));
  if (found == at_.end()) return std::nullopt;
  return found->second;
}

std::optional<SurfacePoint> ProductPlaces::nearest(const Vector3& x) const {
  if (!tree_) return std::nullopt;
  return tree_->closest(x);
}

}  // namespace bespoke
