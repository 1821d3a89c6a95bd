#pragma once

#include <Eigen/Core>
#include <filesystem>

namespace bespoke {

/// 2×3m: the first texture coordinates of a glTF file, of the corners of the triangles as read_product orders
/// them, upwards as OBJ has them; (0, 0) where a primitive has none. Empty where none has any, and for other
/// formats, of which read_product gives them. Throws as read_product.
Eigen::Matrix2Xd corner_texture(const std::filesystem::path& path);

}  // namespace bespoke
