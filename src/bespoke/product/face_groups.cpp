#include "bespoke/product/face_groups.h"

#include <algorithm>
#include <utility>

#include "bespoke/product/faces/face_group_formats.h"
#include "bespoke/strings.h"

namespace bespoke {

FaceGroups face_groups(const std::filesystem::path& path, FaceGroupKind kind) {
  const std::string ending = lower_ending(path);
  std::vector<std::string> of_faces;
  if (ending == ".obj") of_faces = find_obj_face_groups(InputFile(path), kind);
  if (ending == ".gltf" || ending == ".glb") of_faces = find_gltf_face_groups(InputFile(path), kind);
  FaceGroups groups;
  if (std::all_of(of_faces.begin(), of_faces.end(), [](const std::string& name) { return name.empty(); }))
    return groups;
  for (const std::string& name : of_faces) {
    const auto known = std::find(groups.names.begin(), groups.names.end(), name);
    groups.of_polygon.push_back(static_cast<int>(known - groups.names.begin()));
    if (known == groups.names.end()) groups.names.push_back(name);
  }
  return groups;
}

}  // namespace bespoke
