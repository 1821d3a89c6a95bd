#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "bespoke/pipeline/summary_json.h"
#include "bespoke/types.h"

namespace bespoke {

/// The numbers of a scene, as bytes that deflate well: of each array the differences from one number to the
/// next, zigzag (0, −1, 1, −2 … become 0, 1, 2, 3 …), all lowest bytes first, then all second ones, and so
/// on. What every `add` returns is the reference by which the scene's record names the array.
class PackedArrays {
 public:
  /// bits: 16 or 32, which hold every value.
  Json add(std::span<const std::uint32_t> values, int bits);

  /// 3×n, finite, mesh units: each coordinate rounded to one of 65,536 steps of the bounding box, so at most
  /// by 1 / 131,070 of it; all x, then all y, then all z.
  Json add_points(const Points& points);

  /// 3×n, mesh units: every double as it is, its 32 lower and its 32 upper bits as arrays of their own; all
  /// x, then all y, then all z. Coordinates that a float holds leave most of the lower ones 0.
  Json add_exact_points(const Points& points);

  /// Rounded to one of 65,535 steps from the least to the largest; NaN stands for "not known".
  Json add_values(const std::vector<double>& values);

  Json add_faces(const Faces& faces);

  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// A scene: length of the record (4 bytes, little-endian), the record as JSON, the arrays; deflated (RFC
/// 1950).
std::string packed_scene(const Json& record, const PackedArrays& arrays);

}  // namespace bespoke
