#include "bespoke/page/seam_scene.h"

#include <filesystem>

#include "bespoke/error.h"
#include "bespoke/page/detail/mesh_record.h"
#include "bespoke/sha256.h"

namespace bespoke {
namespace {

Json parsed_seams(const std::string& text) {
  if (text.empty()) return {};
  const Json seams = Json::parse(text, nullptr, false);
  if (seams.is_discarded()) throw FormatError("the seams are no JSON");
  return seams;
}

}  // namespace

std::string seam_scene(const SeamInput& input) {
  require_valid(input.mesh, input.path);
  PackedArrays arrays;
  const DisplayMesh whole = display_mesh(input.mesh, static_cast<std::size_t>(input.mesh.faces.cols()));
  const std::string name = std::filesystem::path(input.path).filename().string();
  Json mesh = mesh_record({"product", name, input.mesh, whole, {input.mesh.vertices}, {}, ""}, arrays);
  mesh["exact"] = arrays.add_exact_points(input.mesh.vertices);
  const Json record = {{"page", "seams"},
                       {"title", input.title},
                       {"unit", input.unit},
                       {"command", input.command},
                       {"key", content_hash(input.mesh).substr(0, 16) +
                                   sha256(input.seams.data(), input.seams.size()).substr(0, 16)},
                       {"garment_path", input.path},
                       {"meshes", Json::array({std::move(mesh)})},
                       {"seams", parsed_seams(input.seams)}};
  return packed_scene(record, arrays);
}

}  // namespace bespoke
