#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/mesh_edges.h"

namespace bespoke {

/// What lies where on a product. Any number of threads may use one.
class ProductPlaces {
 public:
  explicit ProductPlaces(const TriangleMesh& product);

  /// The first vertex there, to the bit; both zeros are one.
  std::optional<Eigen::Index> vertex_at(const Vector3& x) const;
  /// Of the faces; empty without any.
  std::optional<SurfacePoint> nearest(const Vector3& x) const;

  /// n: of every vertex the first one at its position.
  const std::vector<int>& first() const { return first_; }
  /// Of these, what edges join.
  const VertexAdjacency& around() const { return around_; }

 private:
  using Key = std::array<std::uint64_t, 3>;
  struct KeyHash {
    std::size_t operator()(const Key& key) const;
  };
  static Key key_of(const Vector3& x);

  std::vector<int> first_;
  VertexAdjacency around_;
  std::unordered_map<Key, Eigen::Index, KeyHash> at_;
  std::optional<ClosestPointTree> tree_;
};

}  // namespace bespoke
