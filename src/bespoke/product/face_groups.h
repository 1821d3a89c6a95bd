#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace bespoke {

/// What faces belong to by a file's own words.
enum class FaceGroupKind {
  groups,     ///< OBJ: g
  objects,    ///< OBJ: o; glTF: the node that shows a primitive
  materials,  ///< OBJ: usemtl; glTF: a primitive
};

struct FaceGroups {
  std::vector<std::string> names;  ///< in the order of their first faces; "" of faces before any name
  std::vector<int> of_polygon;     ///< one a polygon, as read_product orders them: an index into `names`
};

/// Without names for formats that have none, and for files that name none. Throws as read_product.
FaceGroups face_groups(const std::filesystem::path& path, FaceGroupKind kind);

}  // namespace bespoke
