#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/product/gltf/document/gltf_accessor.h"

namespace bespoke {

/// Vertices between others: the first n are a primitive's own, and vertex n + i is in the middle between
/// ends[i], whose numbers are smaller.
struct GltfMiddles {
  std::size_t own = 0;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ends;

  std::size_t count() const { return own + ends.size(); }
  bool operator==(const GltfMiddles&) const = default;
};

/// What a list of a primitive says of every vertex under a name, and how it is stored.
struct GltfVertexData {
  GltfValues values;
  GltfComponent component = GltfComponent::real;
  bool is_normalized = false;
};
using GltfVertexDataByName = std::map<std::string, GltfVertexData>;

/// The attributes of all vertices. In the middle stand means: of directions as long as the ends are, with the
/// first end's sign of a tangent's frame; of joints and weights those of both ends, of which the largest that
/// there is space for keep the sum. Whole numbers that are no shares are names, of which one has no middle
/// but its first end's. Types of components stay, but positions become floats. Throws FormatError naming the
/// JSON pointer of an attribute that has not one value a vertex.
GltfVertexDataByName middle_attributes(const GltfPart& attributes, const std::vector<GltfAccessor>& accessors,
                                       const std::vector<GltfBuffer>& buffers, const GltfMiddles& middles);

/// The same of a morph target, whose differences from these attributes become floats.
GltfVertexDataByName middle_differences(const GltfPart& target, const GltfVertexDataByName& attributes,
                                        const std::vector<GltfAccessor>& accessors,
                                        const std::vector<GltfBuffer>& buffers, const GltfMiddles& middles);

}  // namespace bespoke
