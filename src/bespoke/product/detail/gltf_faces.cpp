#include <vector>

#include "bespoke/error.h"
#include "bespoke/product/detail/face_formats.h"
#include "bespoke/product/detail/gathered_faces.h"
#include "bespoke/product/detail/gltf_triangles.h"

namespace bespoke {

namespace {

Product read_faces_in_pose(const InputFile& input, ModelPose pose) {
  const GltfFile file = read_gltf(input);
  const std::vector<GltfAccessor> accessors = read_accessors(file);
  GatheredFaces gathered(file.path);
  for (const GltfTriangles& triangles : shown_triangles(file, accessors, read_scene(file, accessors, pose)))
    gathered.add_points(triangles.places);
  const Points corners = gathered.product(false).vertices;
  if (corners.cols() == 0) throw FormatError(file.path.string() + ": the scene shows no triangles");
  return joined_triangles(corners);
}

}  // namespace

Product read_gltf_faces(const InputFile& input) { return read_faces_in_pose(input, ModelPose::shown); }

Product read_stored_gltf_faces(const InputFile& input) {
  return read_faces_in_pose(input, ModelPose::stored);
}

}  // namespace bespoke
