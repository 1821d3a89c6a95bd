#include "bespoke/page/pick_scene.h"

#include <algorithm>
#include <filesystem>

#include "bespoke/anchors/anchor_files.h"
#include "bespoke/page/detail/mesh_record.h"

namespace bespoke {
std::string pick_scene(const PickInput& input, const PickOptions& options) {
  PackedArrays arrays;
  Json meshes = Json::array();
  for (const PickModel* model : {&input.source, &input.target}) {
    require_valid(model->mesh, model->path);
    const DisplayMesh display = display_mesh(model->mesh, std::max<std::size_t>(1, options.max_faces / 2));
    const std::string name = std::filesystem::path(model->path).filename().string();
    meshes.push_back(mesh_record({model == &input.source ? "source" : "target",
                                  name,
                                  model->mesh,
                                  display,
                                  {display.shown(model->mesh.vertices)},
                                  {},
                                  ""},
                                 arrays));
    // What files of vertex and triangle numbers mean: a thinned mesh has others.
    meshes.back()["exact"] = display.is_whole ? arrays.add_exact_points(model->mesh.vertices) : Json();
  }
  const Json record = {
      {"page", "pick"},
      {"title", input.title},
      {"unit", input.anchors ? input.anchors->unit : ""},
      {"command", input.command},
      {"key", content_hash(input.source.mesh).substr(0, 16) + content_hash(input.target.mesh).substr(0, 16)},
      {"source_path", input.source.path},
      {"target_path", input.target.path},
      {"meshes", std::move(meshes)},
      {"anchors", input.anchors ? Json::parse(anchors_json(*input.anchors)) : Json()}};
  return packed_scene(record, arrays);
}

}  // namespace bespoke
