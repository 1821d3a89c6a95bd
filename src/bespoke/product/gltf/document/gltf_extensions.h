#pragma once

#include <string_view>

#include "bespoke/product/gltf/document/gltf_json.h"

namespace bespoke {

/// Refuses a file that requires an extension which may change its shapes and is not known here, or which
/// compresses them. Throws InvalidInput naming the JSON pointer and the extension, FormatError for a list
/// that is none.
void require_known_extensions(const GltfPart& root);

/// Throws InvalidInput if the part has an extension that compresses what it holds: "a.glb: /bufferViews/0: is
/// compressed, needs EXT_meshopt_compression: decompress it with …".
void require_not_compressed(const GltfPart& part);

}  // namespace bespoke
