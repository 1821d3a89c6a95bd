#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "bespoke/anchors/anchors.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// A reference model to pick points on.
struct PickModel {
  std::string path;  ///< as typed, for the command that the page shows
  TriangleMesh mesh;
};

struct PickInput {
  const PickModel& source;
  const PickModel& target;
  const std::optional<Anchors>& anchors;  ///< what the work begins with
  std::string title;
  std::string command;  ///< that made the page, as one would type it
};

struct PickOptions {
  std::size_t max_faces = 200000;  ///< triangles of both models together, > 0; more are thinned for display
};

/// The scene of the page `pick` (README.md, "The scene"). A picked point lies on the mesh as shown: within
/// 1e-5 of its bounding-box diagonal of the model, where that was not thinned; then the vertices are also
/// there as they are, for formats that name vertices and triangles. Throws InvalidInput for models that are
/// not valid.
std::string pick_scene(const PickInput& input, const PickOptions& options = {});

}  // namespace bespoke
