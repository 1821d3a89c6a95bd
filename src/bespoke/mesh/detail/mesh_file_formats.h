#pragma once

#include <filesystem>
#include <string>

#include "bespoke/mesh/detail/mesh_file.h"

namespace bespoke {

/// The parts of read_mesh_file, one a format: `content` is the whole file, `path` for messages.
MeshFile check_obj(const std::filesystem::path& path, const std::string& content);
MeshFile check_off(const std::filesystem::path& path, const std::string& content);
MeshFile check_stl(const std::filesystem::path& path, const std::string& content);
MeshFile check_ply(const std::filesystem::path& path, const std::string& content);

}  // namespace bespoke
