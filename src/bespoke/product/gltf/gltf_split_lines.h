#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "bespoke/product/face_splits.h"
#include "bespoke/product/gltf/gltf_middles.h"
#include "bespoke/product/gltf/scene/gltf_triangles.h"

namespace bespoke {

/// Vertices that primitives of a mesh share, and those between them.
struct SplitVertices {
  std::size_t primitive = 0;  ///< the first one
  GltfMiddles middles;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> between = {};  ///< by their ends

  std::uint32_t middle(std::uint32_t a, std::uint32_t b) {
    const auto [found, is_new] =
        between.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(middles.count()));
    if (is_new) middles.ends.push_back(found->first);
    return found->second;
  }
  bool operator==(const SplitVertices& other) const {
    return primitive == other.primitive && middles == other.middles;
  }
};

/// The edges of all lines that the scene shows, as vertices of the product, and where these are split.
class SplitLines {
 public:
  SplitLines(const std::vector<GltfTriangles>& triangles, const std::vector<GltfLines>& lines,
             const FaceSplits& splits);

  /// Edge `edge` of all from vertex a to b of a primitive: the vertices behind a, of which b is the last.
  std::vector<std::uint32_t> chain(std::size_t edge, std::uint32_t a, std::uint32_t b,
                                   SplitVertices& vertices) const;
  bool is_split(std::size_t edge) const;

 private:
  struct End {
    int of_product = 0;
    std::uint32_t of_primitive = 0;
  };

  void append(const End& a, const End& b, SplitVertices& vertices, std::vector<std::uint32_t>& chain) const;

  std::vector<int> ends_;                       // by twos
  std::map<std::pair<int, int>, int> middles_;  // by the ends of what is split
};

}  // namespace bespoke
