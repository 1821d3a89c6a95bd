#include "bespoke/product/gltf/document/gltf_additions.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "bespoke/parallel.h"
#include "bespoke/product/text/number_text.h"

namespace bespoke {
namespace {

constexpr std::size_t bounds_at_a_time = std::size_t{1} << 16;
constexpr std::size_t attribute_alignment = 4;  // bytes

std::size_t aligned_to_attributes(std::size_t size) {
  return (size + attribute_alignment - 1) / attribute_alignment * attribute_alignment;
}

/// Bytes [first, second) of a buffer.
using ByteRange = std::pair<std::size_t, std::size_t>;

/// The views of a buffer, by their bytes, and their numbers.
std::vector<std::pair<ByteRange, std::size_t>> views_of(const GltfPart& root,
                                                        const std::vector<GltfBuffer>& buffers,
                                                        std::size_t buffer) {
  std::vector<std::pair<ByteRange, std::size_t>> result;
  const std::vector<GltfPart> views = root.elements("bufferViews");
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (views[i].index("buffer", buffers.size()) != buffer) continue;
    const std::uint64_t begin = views[i].whole_or("byteOffset", 0), length = views[i].whole("byteLength");
    const std::uint64_t size = buffers[buffer].size();
    if (begin > size || length > size - begin) views[i].fail("ends behind its buffer");
    result.push_back({{begin, begin + length}, i});
  }
  std::sort(result.begin(), result.end());
  return result;
}

/// What `views` have and `others` have not, whole words of four bytes; ascending, none in another.
std::vector<ByteRange> bytes_without(const std::vector<std::pair<ByteRange, std::size_t>>& views,
                                     const std::vector<std::pair<ByteRange, std::size_t>>& others) {
  std::vector<ByteRange> result;
  const auto add = [&](std::size_t begin, std::size_t end) {
    begin = aligned_to_attributes(begin);
    end -= end % attribute_alignment;
    if (begin < end) result.emplace_back(begin, end);
  };
  std::size_t done = 0;
  for (const auto& [view, number] : views) {
    std::size_t at = std::max(view.first, done);
    done = std::max(done, view.second);
    for (auto other = others.begin(); other != others.end() && other->first.first < view.second; ++other) {
      const auto& [begin, end] = other->first;
      if (end <= at) continue;
      if (begin > at) add(at, begin);
      at = end;
    }
    if (at < view.second) add(at, view.second);
  }
  return result;
}

/// Whole numbers without a point.
GltfJson json_number(double value) {
  if (value == std::floor(value) && std::abs(value) < largest_whole) return static_cast<std::int64_t>(value);
  return value;
}

/// Whether the bounds in the file, which may be rounded, are these as floats.
bool is_same(const GltfJson& old, const GltfJson& bounds) {
  if (!old.is_array() || old.size() != bounds.size()) return false;
  for (std::size_t i = 0; i < bounds.size(); ++i)
    if (!old[i].is_number() || old[i].get<float>() != bounds[i].get<float>()) return false;
  return true;
}

}  // namespace

GltfPlace add_view(GltfJson& json, std::vector<GltfBuffer>& buffers, GltfPlace place,
                   std::optional<GltfTarget> target) {
  GltfBuffer& buffer = buffers[place.buffer];
  place.offset = aligned_to_attributes(buffer.size());
  place.stride =
      target == GltfTarget::vertices ? aligned_to_attributes(place.vector_size()) : place.vector_size();
  buffer.grow(place.offset + place.count * place.stride);
  GltfJson view = {
      {"buffer", place.buffer}, {"byteOffset", place.offset}, {"byteLength", buffer.size() - place.offset}};
  if (place.stride != place.vector_size()) view["byteStride"] = place.stride;
  if (target) view["target"] = static_cast<int>(*target);
  json["bufferViews"].push_back(std::move(view));
  json["buffers"][place.buffer]["byteLength"] = buffer.size();
  return place;
}

void drop_bytes_without_view(GltfFile& file, GltfJson& json, std::size_t buffer) {
  const auto views = views_of({file.path, json, ""}, file.buffers, buffer);
  const std::vector<ByteRange> dropped = bytes_without(views_of(file.root(), file.buffers, buffer), views);
  for (const auto& [range, view] : views) {
    std::size_t earlier = 0;
    for (const auto& [first, end] : dropped)
      if (end <= range.first) earlier += end - first;
    if (earlier > 0) json["bufferViews"][view]["byteOffset"] = range.first - earlier;
  }
  const std::string bytes = file.buffers[buffer].content();
  std::string kept;
  std::size_t at = 0;
  for (const auto& [first, end] : dropped) {
    kept.append(bytes, at, first - at);
    at = end;
  }
  kept.append(bytes, at);
  json["buffers"][buffer]["byteLength"] = kept.size();
  file.buffers[buffer] = GltfBuffer(std::move(kept));
}

void update_bounds(GltfJson& accessor, GltfComponent component, bool is_normalized,
                   const GltfValues& values) {
  if (!accessor.contains("min") && !accessor.contains("max")) return;
  struct Bounds {
    Eigen::VectorXf least, most;
  };
  const auto chunk = [&](std::size_t begin, std::size_t end) {
    const auto columns =
        values.middleCols(static_cast<Eigen::Index>(begin), static_cast<Eigen::Index>(end - begin));
    return Bounds{columns.rowwise().minCoeff(), columns.rowwise().maxCoeff()};
  };
  const Bounds first{values.col(0), values.col(0)};
  const Bounds bounds = parallel_reduce(static_cast<std::size_t>(values.cols()), bounds_at_a_time, first,
                                        chunk, [](const Bounds& a, const Bounds& b) {
                                          return Bounds{a.least.cwiseMin(b.least), a.most.cwiseMax(b.most)};
                                        });
  GltfJson least = GltfJson::array(), most = GltfJson::array();
  for (Eigen::Index k = 0; k < values.rows(); ++k) {
    least.push_back(json_number(stored_number(component, is_normalized, bounds.least[k])));
    most.push_back(json_number(stored_number(component, is_normalized, bounds.most[k])));
  }
  if (accessor.contains("min") && !is_same(accessor["min"], least)) accessor["min"] = std::move(least);
  if (accessor.contains("max") && !is_same(accessor["max"], most)) accessor["max"] = std::move(most);
}

}  // namespace bespoke
