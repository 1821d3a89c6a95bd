#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bespoke/product/gltf/document/gltf_additions.h"
#include "bespoke/product/gltf/scene/gltf_plan.h"

namespace bespoke {

/// A glTF file that is being made: what stays of another one, and values that were carried.
class GltfFrame {
 public:
  /// File and accessors must outlive the frame.
  GltfFrame(const GltfFile& file, const std::vector<GltfAccessor>& accessors, GltfJson json)
      : file_(file),
        accessors_(accessors),
        json_(std::move(json)),
        buffers_(file.buffers),
        is_changed_(buffers_.size()) {}

  /// Values of the task's accessor: in place of the old ones where these are floats, or directions in fewer
  /// bits, or sparse with changes only where the file names vectors; else as floats behind the first buffer.
  void store(const GltfTask& task, GltfValues values);

  /// Values that belong to no vertices, as floats: those of an accessor of the file or, without one, of a new
  /// accessor of that type. Returns its number.
  std::size_t store_data(std::optional<std::size_t> accessor, const std::string& type, GltfValues values);

  /// A new accessor behind the first buffer.
  std::size_t add(const std::string& type, GltfComponent component, std::optional<GltfTarget> target,
                  GltfValues values);

  GltfJson& json() { return json_; }
  const std::vector<GltfBuffer>& buffers() const { return buffers_; }
  void name_buffer(std::size_t buffer, const std::string& file_name);

  /// The JSON, with the characters of the file where it says the same.
  std::string text();

 private:
  void store_in(const GltfPlace& place, GltfValues values);
  bool store_sparse(const GltfAccessor& accessor, const GltfValues& values);
  void append(std::size_t accessor, GltfValues values, std::optional<GltfTarget> target);

  const GltfFile& file_;
  const std::vector<GltfAccessor>& accessors_;
  GltfJson json_;
  std::vector<GltfBuffer> buffers_;
  std::vector<bool> is_changed_;  ///< of every buffer
};

}  // namespace bespoke
