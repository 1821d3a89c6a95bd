#include "bespoke/product/gltf/gltf_split_lines.h"

#include <algorithm>

#include "bespoke/product/faces/gathered_faces.h"

namespace bespoke {
namespace {

template <class Shown>
Points places_of(const std::vector<Shown>& shown) {
  Eigen::Index count = 0;
  for (const Shown& own : shown) count += own.places.cols();
  Points places(3, count);
  Eigen::Index at = 0;
  for (const Shown& own : shown) {
    places.middleCols(at, own.places.cols()) = own.places;
    at += own.places.cols();
  }
  return places;
}

}  // namespace

SplitLines::SplitLines(const std::vector<GltfTriangles>& triangles, const std::vector<GltfLines>& lines,
                       const FaceSplits& splits) {
  if (lines.empty()) return;
  const Product product = joined_triangles(places_of(triangles), places_of(lines));
  ends_ = product.line_edges;
  auto vertex = static_cast<int>(product.vertices.cols());
  for (const std::pair<int, int>& ends : splits.vertices)
    middles_.emplace(std::minmax(ends.first, ends.second), vertex++);
}

std::vector<std::uint32_t> SplitLines::chain(std::size_t edge, std::uint32_t a, std::uint32_t b,
                                             SplitVertices& vertices) const {
  std::vector<std::uint32_t> result;
  append({ends_[2 * edge], a}, {ends_[2 * edge + 1], b}, vertices, result);
  return result;
}

bool SplitLines::is_split(std::size_t edge) const {
  return middles_.contains(std::minmax(ends_[2 * edge], ends_[2 * edge + 1]));
}

void SplitLines::append(const End& a, const End& b, SplitVertices& vertices,
                        std::vector<std::uint32_t>& chain) const {
  const auto found = middles_.find(std::minmax(a.of_product, b.of_product));
  if (found == middles_.end()) {
    chain.push_back(b.of_primitive);
    return;
  }
  const End middle{found->second, vertices.middle(a.of_primitive, b.of_primitive)};
  append(a, middle, vertices, chain);
  append(middle, b, vertices, chain);
}

}  // namespace bespoke
