#include "bespoke/page/detail/packed_arrays.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "bespoke/error.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {
namespace {

constexpr std::uint32_t largest_code = 65535;
constexpr std::uint32_t unknown_code = largest_code;  // of values
constexpr std::uint32_t largest_value_code = largest_code - 1;

std::uint32_t code_of(double value, double low, double high, std::uint32_t most) {
  if (!(high > low)) return 0;
  return static_cast<std::uint32_t>(std::lround((value - low) / (high - low) * most));
}

/// The difference within `bits` bits, small in amount becoming small in value.
std::uint32_t zigzag(std::uint32_t difference, int bits) {
  const std::uint32_t mask = bits == 32 ? ~std::uint32_t{0} : (std::uint32_t{1} << bits) - 1;
  const bool is_negative = difference >> (bits - 1) & 1;
  return ((difference << 1) ^ (is_negative ? ~std::uint32_t{0} : 0)) & mask;
}

}  // namespace

Json PackedArrays::add(std::span<const std::uint32_t> values, int bits) {
  const std::size_t at = bytes_.size(), count = values.size();
  bytes_.resize(at + count * static_cast<std::size_t>(bits / 8));
  std::uint32_t previous = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t code = zigzag(values[i] - previous, bits);
    for (int plane = 0; plane < bits / 8; ++plane)
      bytes_[at + static_cast<std::size_t>(plane) * count + i] =
          static_cast<char>(code >> (8 * plane) & 0xFF);
    previous = values[i];
  }
  return {{"at", at}, {"count", count}, {"bits", bits}};
}

Json PackedArrays::add_points(const Points& points) {
  const Box box = points.cols() > 0 ? bounding_box(points) : Box(Vector3::Zero(), Vector3::Zero());
  std::vector<std::uint32_t> codes;
  codes.reserve(static_cast<std::size_t>(points.size()));
  for (int axis = 0; axis < 3; ++axis)
    for (Eigen::Index i = 0; i < points.cols(); ++i)
      codes.push_back(code_of(points(axis, i), box.min()[axis], box.max()[axis], largest_code));
  return {
      {"array", add(codes, 16)}, {"min", to_json(Vector3(box.min()))}, {"max", to_json(Vector3(box.max()))}};
}

Json PackedArrays::add_exact_points(const Points& points) {
  std::vector<std::uint32_t> low, high;
  for (int axis = 0; axis < 3; ++axis)
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      const auto bits = std::bit_cast<std::uint64_t>(points(axis, i));
      low.push_back(static_cast<std::uint32_t>(bits));
      high.push_back(static_cast<std::uint32_t>(bits >> 32));
    }
  return {{"low", add(low, 32)}, {"high", add(high, 32)}};
}

Json PackedArrays::add_values(const std::vector<double>& values) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double value : values) {
    if (std::isnan(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  if (!(low <= high)) low = high = 0;  // nothing is known
  std::vector<std::uint32_t> codes;
  codes.reserve(values.size());
  for (const double value : values)
    codes.push_back(std::isnan(value) ? unknown_code : code_of(value, low, high, largest_value_code));
  return {{"array", add(codes, 16)}, {"min", low}, {"max", high}};
}

Json PackedArrays::add_faces(const Faces& faces) {
  std::vector<std::uint32_t> corners(static_cast<std::size_t>(faces.size()));
  std::copy(faces.data(), faces.data() + faces.size(), corners.begin());
  return add(corners, 32);
}

std::string packed_scene(const Json& record, const PackedArrays& arrays) {
  const std::string text = record.dump();
  std::string plain;
  for (int byte = 0; byte < 4; ++byte) plain += static_cast<char>(text.size() >> (8 * byte) & 0xFF);
  plain += text + arrays.bytes();
  uLongf size = compressBound(static_cast<uLong>(plain.size()));
  std::string packed(size, '\0');
  const int result =
      compress2(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(plain.data()),
                static_cast<uLong>(plain.size()), Z_BEST_COMPRESSION);
  if (result != Z_OK)
    throw MemoryLimitError("a scene of " + std::to_string(plain.size()) + " bytes: no memory to deflate it");
  packed.resize(size);
  return packed;
}

}  // namespace bespoke
