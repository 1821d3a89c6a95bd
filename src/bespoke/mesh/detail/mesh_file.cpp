#include "bespoke/mesh/detail/mesh_file.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "bespoke/error.h"
#include "bespoke/mesh/detail/mesh_file_formats.h"

namespace bespoke {
namespace {

namespace fs = std::filesystem;

std::string read_bytes(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw FileError("cannot read " + path.string() + ": " + std::strerror(ENOENT));
  if (!fs::is_regular_file(status)) throw FileError("cannot read " + path.string() + ": not a regular file");
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  std::string content;
  if (stream) {
    content.resize(fs::file_size(path, error));
    stream.read(content.data(), static_cast<std::streamsize>(content.size()));
  }
  if (!stream) throw FileError("cannot read " + path.string() + ": " + std::strerror(errno));
  if (content.empty()) throw FormatError(path.string() + ": the file is empty");
  return content;
}

}  // namespace

MeshFormat mesh_format(const fs::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == ".obj") return MeshFormat::obj;
  if (ending == ".ply") return MeshFormat::ply;
  if (ending == ".stl") return MeshFormat::stl;
  if (ending == ".off") return MeshFormat::off;
  throw InvalidInput(path.string() + ": the name must end in .obj, .ply, .stl or .off");
}

MeshFile read_mesh_file(const fs::path& path) {
  const MeshFormat format = mesh_format(path);
  const std::string content = read_bytes(path);
  switch (format) {
    case MeshFormat::obj:
      return check_obj(path, content);
    case MeshFormat::ply:
      return check_ply(path, content);
    case MeshFormat::stl:
      return check_stl(path, content);
    case MeshFormat::off:
      break;
  }
  return check_off(path, content);
}

}  // namespace bespoke
