#include "bespoke/page/pick_scene.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "bespoke/page/detail/mesh_record.h"

namespace bespoke {
namespace {

Json polyline_json(const Points& points) {
  Json json = Json::array();
  for (const auto& point : points.colwise()) json.push_back(to_json(Vector3(point)));
  return json;
}

Json patch_json(const AnchorPatch& patch) {
  Json json = Json::object();
  if (!patch.name.empty()) json["name"] = patch.name;
  if (patch.exclude) json["exclude"] = true;
  for (const auto& [key, side] : {std::pair{"a", &patch.a}, {"b", &patch.b}}) {
    if (side->is_empty()) continue;
    if (side->faces.empty())
      json[key] = {{"border", polyline_json(side->border)}};
    else
      json[key] = {{"faces", side->faces}};
  }
  return json;
}

Json anchors_json(const Anchors& anchors) {
  Json pairs = Json::array();
  for (const AnchorPair& pair : anchors.pairs) {
    Json json = {{"name", pair.name}, {"a", to_json(pair.a)}, {"b", to_json(pair.b)}};
    if (std::isfinite(pair.weight)) json["weight"] = pair.weight;
    if (pair.sigma) json["sigma"] = *pair.sigma;
    pairs.push_back(std::move(json));
  }
  Json curves = Json::array();
  for (const AnchorCurve& curve : anchors.curves)
    curves.push_back({{"name", curve.name},
                      {"a", polyline_json(curve.a)},
                      {"b", polyline_json(curve.b)},
                      {"closed", curve.closed},
                      {"fixed", curve.fixed}});
  Json patches = Json::array();
  for (const AnchorPatch& patch : anchors.patches) patches.push_back(patch_json(patch));
  return {{"units", anchors.unit},
          {"pairs", std::move(pairs)},
          {"curves", std::move(curves)},
          {"patches", std::move(patches)}};
}

}  // namespace

std::string pick_scene(const PickInput& input, const PickOptions& options) {
  PackedArrays arrays;
  Json meshes = Json::array();
  for (const PickModel* model : {&input.source, &input.target}) {
    require_valid(model->mesh, model->path);
    const DisplayMesh display = display_mesh(model->mesh, std::max<std::size_t>(1, options.most_faces / 2));
    const std::string name = std::filesystem::path(model->path).filename().string();
    meshes.push_back(mesh_record({model == &input.source ? "source" : "target",
                                  name,
                                  model->mesh,
                                  display,
                                  {display.shown(model->mesh.vertices)},
                                  {},
                                  ""},
                                 arrays));
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
      {"anchors", input.anchors ? anchors_json(*input.anchors) : Json()}};
  return packed_scene(record, arrays);
}

}  // namespace bespoke
