#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bespoke/product/gltf/document/gltf_accessor.h"

namespace bespoke {

/// What a buffer's view is for, by its number in the file.
enum class GltfTarget { vertices = 34962, indices = 34963 };

/// Adds space behind the bytes of `place.buffer` for vectors as `place` says, and appends a view of them to
/// the JSON. Returns where they go: each vector of a vertex attribute at a multiple of four bytes.
GltfPlace add_view(GltfJson& json, std::vector<GltfBuffer>& buffers, GltfPlace place,
                   std::optional<GltfTarget> target);

/// Takes bytes out of a buffer of the file that its views have and those of `json`, what the file becomes,
/// have not; views behind them begin earlier. Bytes that no view had stay. Throws FormatError for a view that
/// ends behind the buffer.
void drop_bytes_without_view(GltfFile& file, GltfJson& json, std::size_t buffer);

/// Gives the JSON of an accessor that has bounds those of its values as they are stored.
void update_bounds(GltfJson& accessor, GltfComponent component, bool is_normalized, const GltfValues& values);

}  // namespace bespoke
