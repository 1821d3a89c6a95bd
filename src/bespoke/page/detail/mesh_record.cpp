#include "bespoke/page/detail/mesh_record.h"

#include <utility>

namespace bespoke {

Json mesh_record(const MeshToShow& mesh, PackedArrays& arrays) {
  Json places = Json::array(), fields = Json::array();
  for (const Points& points : mesh.knots) places.push_back(arrays.add_points(points));
  for (const VertexField& field : mesh.fields)
    fields.push_back({{"id", field.id},
                      {"label", field.label},
                      {"unit", field.is_length ? mesh.unit : ""},
                      {"middle", field.middle ? Json(*field.middle) : Json()},
                      {"values", arrays.add_values(field.values)}});
  Json original;
  if (!mesh.display.is_whole) {
    const std::vector<std::uint32_t> numbers(mesh.display.original.begin(), mesh.display.original.end());
    original = arrays.add(numbers, 32);
  }
  return {{"role", mesh.role},
          {"name", mesh.name},
          {"faces", arrays.add_faces(mesh.display.faces)},
          {"faces_in_file", mesh.whole.faces.cols()},
          {"vertices_in_file", mesh.whole.vertices.cols()},
          {"original", std::move(original)},
          {"places", std::move(places)},
          {"fields", std::move(fields)}};
}

}  // namespace bespoke
