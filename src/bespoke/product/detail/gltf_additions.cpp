#include "bespoke/product/detail/gltf_additions.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "bespoke/parallel.h"
#include "bespoke/product/detail/number_text.h"

namespace bespoke {
namespace {

constexpr std::size_t bounds_at_a_time = std::size_t{1} << 16;
constexpr std::size_t attribute_alignment = 4;  // bytes

std::size_t aligned_to_attributes(std::size_t size) {
  return (size + attribute_alignment - 1) / attribute_alignment * attribute_alignment;
}

/// Bytes [first, second) of a buffer.
using ByteRange = std::pair<std::size_t, std::size_t>;

/// Those of the views of a buffer, ascending.
std::vector<ByteRange> ranges_of_views(const GltfPart& root, const std::vector<std::string>& buffers,
                                       std::size_t buffer) {
  std::vector<ByteRange> ranges;
  for (const GltfPart& view : root.elements("bufferViews")) {
    if (view.index("buffer", buffers.size()) != buffer) continue;
    const std::uint64_t begin = view.whole_or("byteOffset", 0), length = view.whole("byteLength");
    const std::uint64_t size = buffers[buffer].size();
    if (begin > size || length > size - begin) view.fail("ends behind its buffer");
    ranges.emplace_back(begin, begin + length);
  }
  std::sort(ranges.begin(), ranges.end());
  return ranges;
}

/// The parts of `ranges`, whole words of four bytes, that are in none of `used`; ascending, none in another.
std::vector<ByteRange> ranges_without(const std::vector<ByteRange>& ranges,
                                      const std::vector<ByteRange>& used) {
  std::vector<ByteRange> result;
  std::size_t done = 0;
  const auto add = [&](std::size_t begin, std::size_t end) {
    begin = aligned_to_attributes(begin);
    end -= end % attribute_alignment;
    if (begin < end) result.emplace_back(begin, end);
  };
  for (const auto& [begin, end] : ranges) {
    std::size_t at = std::max(begin, done);
    for (const auto& [used_begin, used_end] : used) {
      if (used_begin >= end) break;
      if (used_end <= at) continue;
      if (used_begin > at) add(at, used_begin);
      at = used_end;
    }
    if (at < end) add(at, end);
    done = std::max(done, end);
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

GltfPlace add_view(GltfJson& json, std::vector<std::string>& buffers, GltfPlace room,
                   std::optional<GltfTarget> target) {
  std::string& buffer = buffers[room.buffer];
  room.offset = aligned_to_attributes(buffer.size());
  room.stride =
      target == GltfTarget::vertices ? aligned_to_attributes(room.vector_size()) : room.vector_size();
  buffer.resize(room.offset + room.count * room.stride);
  GltfJson view = {
      {"buffer", room.buffer}, {"byteOffset", room.offset}, {"byteLength", buffer.size() - room.offset}};
  if (room.stride != room.vector_size()) view["byteStride"] = room.stride;
  if (target) view["target"] = static_cast<int>(*target);
  json["bufferViews"].push_back(std::move(view));
  json["buffers"][room.buffer]["byteLength"] = buffer.size();
  return room;
}

void drop_bytes_without_view(GltfFile& file, GltfJson& json, std::size_t buffer) {
  std::string& bytes = file.buffers[buffer];
  const std::vector<ByteRange> dropped =
      ranges_without(ranges_of_views(file.root(), file.buffers, buffer),
                     ranges_of_views({file.path, json, ""}, file.buffers, buffer));
  for (GltfJson& view : json["bufferViews"]) {
    const std::size_t begin = view.value("byteOffset", std::size_t{0});
    std::size_t earlier = 0;
    for (const auto& [first, end] : dropped)
      if (end <= begin) earlier += end - first;
    if (earlier > 0 && view["buffer"] == buffer) view["byteOffset"] = begin - earlier;
  }
  std::string kept;
  std::size_t at = 0;
  for (const auto& [first, end] : dropped) {
    kept.append(bytes, at, first - at);
    at = end;
  }
  bytes = kept.append(bytes, at);
  json["buffers"][buffer]["byteLength"] = bytes.size();
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
