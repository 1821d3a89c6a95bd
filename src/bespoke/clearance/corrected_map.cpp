#include "bespoke/clearance/corrected_map.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/equal_positions.h"
#include "bespoke/mesh/mesh_edges.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

constexpr std::size_t places_per_range = 512;

// Relative to the edges around a vertex: keeps the gradient zero in directions that no edge has.
constexpr double gradient_regularisation = 1e-6;

using PlaceKey = std::array<std::uint64_t, 3>;

struct PlaceKeyHash {
  std::size_t operator()(const PlaceKey& key) const {
    std::uint64_t hash = 0;
    for (const std::uint64_t bits : key) {
      hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
      hash ^= hash >> 32;
    }
    return static_cast<std::size_t>(hash);
  }
};

/// Both zeros are one.
PlaceKey key_of(const Vector3& x) {
  return {std::bit_cast<std::uint64_t>(x[0] + 0.0), std::bit_cast<std::uint64_t>(x[1] + 0.0),
          std::bit_cast<std::uint64_t>(x[2] + 0.0)};
}

/// What moves vertices, at the product's places and between them.
class PlaceMoves {
 public:
  PlaceMoves(const TriangleMesh& product, Points moves) : faces_(product.faces), moves_(std::move(moves)) {
    const std::vector<int> first = first_at_equal_position(product.vertices);
    for (Eigen::Index v = 0; v < product.vertices.cols(); ++v)
      at_.emplace(key_of(product.vertices.col(v)), v);
    TriangleMesh joined = product;
    for (int& vertex : joined.faces.reshaped()) vertex = first[static_cast<std::size_t>(vertex)];
    set_gradients(joined);
    for (std::size_t v = 0; v < first.size(); ++v)
      gradients_.middleCols<3>(3 * static_cast<Eigen::Index>(v)) =
          gradients_.middleCols<3>(3 * Eigen::Index{first[v]}).eval();
    if (faces_.cols() > 0) tree_.emplace(product);
  }

  Vector3 move(const Vector3& x) const {
    if (const auto found = at_.find(key_of(x)); found != at_.end()) return moves_.col(found->second);
    if (!tree_) return Vector3::Zero();
    const SurfacePoint near = *tree_->closest(x);
    Vector3 sum = Vector3::Zero();
    for (int k = 0; k < 3; ++k) sum += near.barycentric[k] * moves_.col(faces_(k, near.face));
    return sum;
  }

  /// By the coordinates of x.
  Matrix3 gradient(const Vector3& x) const {
    if (const auto found = at_.find(key_of(x)); found != at_.end())
      return gradients_.middleCols<3>(3 * found->second);
    if (!tree_) return Matrix3::Zero();
    const SurfacePoint near = *tree_->closest(x);
    Matrix3 sum = Matrix3::Zero();
    for (int k = 0; k < 3; ++k)
      sum += near.barycentric[k] * gradients_.middleCols<3>(3 * Eigen::Index{faces_(k, near.face)});
    return sum;
  }

 private:
  void set_gradients(const TriangleMesh& joined) {
    const VertexAdjacency around = vertex_adjacency(joined);
    gradients_ = Points::Zero(3, 3 * joined.vertices.cols());
    for (Eigen::Index v = 0; v < joined.vertices.cols(); ++v) {
      Matrix3 edges = Matrix3::Zero(), changes = Matrix3::Zero();
      bool any = false;
      for (int i = around.start[static_cast<std::size_t>(v)];
           i < around.start[static_cast<std::size_t>(v) + 1]; ++i) {
        const int other = around.neighbours[static_cast<std::size_t>(i)];
        const Vector3 edge = joined.vertices.col(other) - joined.vertices.col(v);
        const Vector3 change = moves_.col(other) - moves_.col(v);
        any = any || !change.isZero(0);
        edges += edge * edge.transpose();
        changes += change * edge.transpose();
      }
      if (!any || !(edges.trace() > 0)) continue;
      edges += gradient_regularisation * edges.trace() * Matrix3::Identity();
      gradients_.middleCols<3>(3 * v) = edges.ldlt().solve(changes.transpose()).transpose();
    }
  }

  Faces faces_;
  Points moves_, gradients_;
  std::unordered_map<PlaceKey, Eigen::Index, PlaceKeyHash> at_;
  std::optional<ClosestPointTree> tree_;
};

class CorrectedMap : public ElasticMap {
 public:
  CorrectedMap(std::shared_ptr<const ElasticMap> elastic, const TriangleMesh& product, Points moves)
      : elastic_(std::move(elastic)), moves_(product, std::move(moves)) {}

  AffineMap affine() const override { return elastic_->affine(); }
  Support support() const override { return elastic_->support(); }

  Points displacement(const Points& x) const override {
    Points u = elastic_->displacement(x);
    parallel_for(static_cast<std::size_t>(x.cols()), places_per_range,
                 [&](std::size_t begin, std::size_t end) {
                   for (auto i = static_cast<Eigen::Index>(begin); i < static_cast<Eigen::Index>(end); ++i)
                     if (const Vector3 move = moves_.move(x.col(i)); !move.isZero(0)) u.col(i) += move;
                 });
    return u;
  }

  Points displacement_gradient(const Points& x) const override {
    Points gradient = elastic_->displacement_gradient(x);
    parallel_for(static_cast<std::size_t>(x.cols()), places_per_range,
                 [&](std::size_t begin, std::size_t end) {
                   for (auto i = static_cast<Eigen::Index>(begin); i < static_cast<Eigen::Index>(end); ++i)
                     if (const Matrix3 further = moves_.gradient(x.col(i)); !further.isZero(0))
                       gradient.middleCols<3>(3 * i) += further;
                 });
    return gradient;
  }

 private:
  std::shared_ptr<const ElasticMap> elastic_;
  PlaceMoves moves_;
};

}  // namespace

std::shared_ptr<const ElasticMap> corrected_map(std::shared_ptr<const ElasticMap> elastic,
                                                const RigidTransform& target_from_source,
                                                const TriangleMesh& product, const Points& carried,
                                                const Points& corrected) {
  if (carried.cols() != product.vertices.cols() || corrected.cols() != carried.cols())
    throw InvalidInput("corrected_map got " + std::to_string(corrected.cols()) + " corrected and " +
                       std::to_string(carried.cols()) + " carried vertices of " +
                       std::to_string(product.vertices.cols()));
  return std::make_shared<CorrectedMap>(std::move(elastic), product,
                                        target_from_source.rotation.transpose() * (corrected - carried));
}

}  // namespace bespoke
