#include <vector>

#include "bespoke/error.h"
#include "bespoke/product/faces/face_formats.h"
#include "bespoke/product/faces/gathered_faces.h"
#include "bespoke/product/gltf/scene/gltf_triangles.h"

namespace bespoke {

namespace {

Product read_faces_in_pose(const InputFile& input, ModelPose pose) {
  const GltfFile file = read_gltf(input);
  const std::vector<GltfAccessor> accessors = read_accessors(file);
  const GltfScene scene = read_scene(file, accessors, pose);
  GatheredFaces triangles(file.path), lines(file.path);
  for (const GltfTriangles& shown : shown_triangles(file, accessors, scene))
    triangles.add_points(shown.places);
  for (const GltfLines& shown : shown_lines(file, accessors, scene)) lines.add_points(shown.places);
  const Points corners = triangles.product(false).vertices, line_ends = lines.product(false).vertices;
  if (corners.cols() == 0 && line_ends.cols() == 0)
    throw FormatError(file.path.string() + ": the scene shows neither triangles nor lines");
  return joined_triangles(corners, line_ends);
}

}  // namespace

Product read_gltf_faces(const InputFile& input) { return read_faces_in_pose(input, ModelPose::shown); }

Product read_stored_gltf_faces(const InputFile& input) {
  return read_faces_in_pose(input, ModelPose::stored);
}

Product read_gltf_model_faces(const InputFile& input, ModelPose pose) {
  const GltfFile file = read_gltf(input);
  const std::vector<GltfAccessor> accessors = read_accessors(file);
  GatheredFaces gathered(file.path);
  for (const GltfTriangles& triangles : shown_triangles(file, accessors, read_scene(file, accessors, pose)))
    gathered.add_points(triangles.places);
  const Points corners = gathered.product(false).vertices;
  if (corners.cols() == 0) throw FormatError(file.path.string() + ": the scene shows no triangles");
  return joined_triangles(corners);
}

}  // namespace bespoke
