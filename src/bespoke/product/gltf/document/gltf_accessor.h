#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/product/gltf/document/gltf_file.h"

namespace bespoke {

/// The types of components that matter, by their numbers in the file.
enum class GltfComponent { int8 = 5120, uint8, int16, uint16, uint32 = 5125, real = 5126 };

/// Vectors in a buffer.
struct GltfPlace {
  GltfComponent component = GltfComponent::real;
  bool is_normalized = false;  ///< whole numbers stand for values in [0, 1] or [-1, 1]
  std::size_t components = 0;  ///< of a vector, 1 … 16
  std::size_t count = 0;       ///< of vectors
  std::size_t buffer = 0;
  std::size_t offset = 0, stride = 0;  ///< bytes, in the buffer

  std::size_t vector_size() const;
  /// Rows of bytes, one a vector, where the vectors are.
  GltfRows rows(std::string packed) const;
  std::size_t end() const { return count == 0 ? offset : offset + (count - 1) * stride + vector_size(); }
};

/// Where an accessor has its values.
struct GltfAccessor {
  std::string pointer;  ///< in the JSON
  std::string type;     ///< "SCALAR", "VEC3", …
  GltfComponent component = GltfComponent::real;
  bool is_normalized = false;
  std::size_t components = 0, count = 0;
  std::optional<GltfPlace> dense;  ///< else zeros
  struct Sparse {
    std::vector<std::uint32_t> indices;  ///< strictly rising
    GltfPlace values;                    ///< instead of those
  };
  std::optional<Sparse> sparse;
};

/// One column a vector.
using GltfValues = Eigen::MatrixXf;

/// Reads and checks what the file says of its accessors: all their values lie in its buffers. Throws
/// FormatError naming the JSON pointer at fault, and InvalidInput for compressed values.
std::vector<GltfAccessor> read_accessors(const GltfFile& file);

/// Vectors [first, first + count) of an accessor in these bytes of the buffers. Floats hold whole numbers of
/// up to 24 bits exactly.
GltfValues read_values(const GltfAccessor& accessor, const std::vector<GltfBuffer>& buffers,
                       std::size_t first, std::size_t count);

/// The number that stands for a value: itself, or the nearest whole number of the component's type.
double stored_number(GltfComponent component, bool is_normalized, float value);

/// The bytes of all vectors of a place. Floats stay where they are.
GltfRows rows_of_values(const GltfPlace& place, GltfValues values);

/// For every accessor, whether bytes of its own values belong to another accessor as well.
std::vector<bool> shares_bytes(const std::vector<GltfAccessor>& accessors);

}  // namespace bespoke
