#pragma once

#include <string>
#include <vector>

#include "bespoke/product/carry/product_file.h"
#include "bespoke/product/face_groups.h"

namespace bespoke {

/// The names of face_groups.h, one a polygon; empty where there is none.
std::vector<std::string> find_obj_face_groups(const InputFile& file, FaceGroupKind kind);
std::vector<std::string> find_gltf_face_groups(const InputFile& file, FaceGroupKind kind);

}  // namespace bespoke
