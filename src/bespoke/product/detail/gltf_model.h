#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bespoke/product/detail/product_file.h"

namespace bespoke {

using GltfJson = nlohmann::ordered_json;

/// Where an accessor's values stand.
struct GltfAccessor {
  std::size_t index = 0;
  int component_type = 0;   ///< 5120 … 5126
  int components = 0;       ///< 1 … 16
  std::uint64_t count = 0;  ///< of vectors
  bool is_normalized = false;
  bool has_view = false;  ///< otherwise zeros
  bool is_sparse = false;
  std::size_t buffer = 0;
  std::uint64_t offset = 0, stride = 0;  ///< bytes, in the buffer
};

/// A glTF file, .gltf or .glb, with its buffers, checked: every accessor lies in its buffer.
struct GltfModel {
  std::filesystem::path path;
  bool is_binary = false;
  std::string text;  ///< the JSON, as it stands in the file
  GltfJson json;
  std::vector<std::string> buffers;
  std::string chunks_behind;  ///< of a .glb
  std::vector<GltfAccessor> accessors;

  /// FormatError "path: pointer: what".
  [[noreturn]] void fail(const std::string& pointer, const std::string& what) const;

  /// The values of an accessor, components × count, normalised ones in [-1, 1], sparse ones in their places.
  Eigen::MatrixXd values(std::size_t accessor) const;
};

/// Throws FileError, FormatError naming the byte or the JSON pointer at fault, and InvalidInput for files
/// with compressed geometry.
GltfModel read_gltf(const InputFile& file);

/// Bytes of a component; 0 for an unknown type.
std::size_t component_size(int component_type);

/// The largest whole number of a component type, to which normalised values are relative; 0 for floats.
double component_limit(int component_type);

/// Stores values (components × count) in the bytes of a buffer, whole numbers rounded to nearest.
void store_values(const GltfAccessor& accessor, const Eigen::MatrixXd& values, std::string& buffer);

/// The .glb or .gltf with this JSON text and the first buffer as its binary chunk, if it has one.
std::string glb_bytes(const GltfModel& model, const std::string& text, const std::string& buffer);

}  // namespace bespoke
