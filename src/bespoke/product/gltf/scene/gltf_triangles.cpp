#include "bespoke/product/gltf/scene/gltf_triangles.h"

#include <cstring>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/product/gltf/document/gltf_extensions.h"

namespace bespoke {
namespace {

// A primitive's `mode`; 0 are points, 3 and 5 are strips.
constexpr std::uint64_t lines_mode = 1, loop_mode = 2, line_strip_mode = 3, triangles_mode = 4, fan_mode = 6;

std::vector<std::uint32_t> read_indices(const GltfAccessor& accessor, const GltfFile& file) {
  std::vector<std::uint32_t> indices(accessor.count, 0);
  const bool is_whole = accessor.component == GltfComponent::uint8 ||
                        accessor.component == GltfComponent::uint16 ||
                        accessor.component == GltfComponent::uint32;
  if (accessor.components != 1 || !is_whole || accessor.sparse)
    throw FormatError(file.path.string() + ": " + accessor.pointer +
                      ": indices must be whole numbers without a sign, and not sparse");
  if (!accessor.dense) return indices;
  const GltfPlace& place = *accessor.dense;
  std::string places(place.end() - place.offset, '\0');
  file.buffers[place.buffer].read(place.offset, places.data(), places.size());
  const char* bytes = places.data();
  for (std::uint32_t& index : indices) {
    std::memcpy(&index, bytes, place.vector_size());  // the rest of the number is 0
    bytes += place.stride;
  }
  return indices;
}

/// Three indices a triangle.
std::vector<std::uint32_t> triangles(const std::vector<std::uint32_t>& indices, std::uint64_t mode) {
  if (mode == triangles_mode) return indices;
  std::vector<std::uint32_t> result;
  for (std::size_t i = 2; i < indices.size(); ++i) {
    if (mode == fan_mode)
      result.insert(result.end(), {indices[0], indices[i - 1], indices[i]});
    else if (i % 2 == 0)
      result.insert(result.end(), {indices[i - 2], indices[i - 1], indices[i]});
    else
      result.insert(result.end(), {indices[i - 1], indices[i - 2], indices[i]});
  }
  return result;
}

void require_values(const GltfPart& primitive, const GltfAccessor& positions) {
  if (positions.components != 3) primitive.fail("its positions are no VEC3");
  if (!positions.dense && !positions.sparse) require_not_compressed(primitive);
}

/// Two indices an edge.
std::vector<std::uint32_t> line_edges(const std::vector<std::uint32_t>& indices, std::uint64_t mode) {
  if (mode == lines_mode) return indices;
  std::vector<std::uint32_t> result;
  for (std::size_t i = 1; i < indices.size(); ++i) result.insert(result.end(), {indices[i - 1], indices[i]});
  if (mode == loop_mode && indices.size() > 1) result.insert(result.end(), {indices.back(), indices.front()});
  return result;
}

/// The vertices that a primitive names, in its order.
std::vector<std::uint32_t> named_vertices(const GltfPart& primitive, const GltfFile& file,
                                          const std::vector<GltfAccessor>& accessors, std::size_t vertices) {
  std::vector<std::uint32_t> indices(vertices);
  std::iota(indices.begin(), indices.end(), 0u);
  if (const auto own = primitive.index("indices", accessors.size()))
    indices = read_indices(accessors[*own], file);
  for (const std::uint32_t index : indices)
    if (index >= vertices)
      primitive.fail("names vertex " + std::to_string(index) + " of " + std::to_string(vertices));
  return indices;
}

/// In the primitive's own order; none for points, lines and what has no positions.
std::vector<std::uint32_t> read_triangles(const GltfPart& primitive, const GltfFile& file,
                                          const std::vector<GltfAccessor>& accessors, std::size_t vertices) {
  const std::uint64_t mode = primitive.whole_or("mode", triangles_mode);
  if (mode < triangles_mode || mode > fan_mode) return {};
  std::vector<std::uint32_t> indices = triangles(named_vertices(primitive, file, accessors, vertices), mode);
  if (indices.size() % 3 != 0)
    primitive.fail(std::to_string(indices.size()) + " indices are no whole number of triangles");
  return indices;
}

/// The same of lines.
std::vector<std::uint32_t> read_lines(const GltfPart& primitive, const GltfFile& file,
                                      const std::vector<GltfAccessor>& accessors, std::size_t vertices) {
  const std::uint64_t mode = primitive.whole_or("mode", triangles_mode);
  if (mode < lines_mode || mode > line_strip_mode) return {};
  std::vector<std::uint32_t> ends = line_edges(named_vertices(primitive, file, accessors, vertices), mode);
  if (ends.size() % 2 != 0)
    primitive.fail(std::to_string(ends.size()) + " indices are no whole number of lines");
  return ends;
}

/// `add(shown, primitive, corners, placement, places)` for every primitive that the scene shows and of which
/// `read` finds corners.
template <class Read, class Add>
void visit_shown(const GltfFile& file, const std::vector<GltfAccessor>& accessors, const GltfScene& scene,
                 const Read& read, const Add& add) {
  const std::vector<GltfPart> meshes = file.root().elements("meshes");
  for (std::size_t shown = 0; shown < scene.shown.size(); ++shown) {
    const std::vector<GltfPart> primitives = meshes[scene.shown[shown].mesh].elements("primitives");
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      const auto positions = primitives[p].member("attributes").index("POSITION", accessors.size());
      if (!positions) continue;
      const GltfAccessor& vertices = accessors[*positions];
      std::vector<std::uint32_t> corners = read(primitives[p], file, accessors, vertices.count);
      if (corners.empty()) continue;
      require_values(primitives[p], vertices);
      const GltfPlacement place = placement(file, scene, scene.shown[shown], primitives[p], accessors);
      const Points x = in_scene(place, read_values(vertices, file.buffers, 0, vertices.count).cast<double>());
      add(shown, p, std::move(corners), place, x);
    }
  }
}

}  // namespace

void turn_over(std::vector<std::uint32_t>& corners) {
  for (std::size_t i = 0; i < corners.size(); i += 3) std::swap(corners[i + 1], corners[i + 2]);
}

std::vector<GltfTriangles> shown_triangles(const GltfFile& file, const std::vector<GltfAccessor>& accessors,
                                           const GltfScene& scene) {
  std::vector<GltfTriangles> result;
  visit_shown(file, accessors, scene, read_triangles,
              [&](std::size_t shown, std::size_t primitive, std::vector<std::uint32_t> corners,
                  const GltfPlacement& place, const Points& x) {
                const bool is_mirrored = place.at(0).linear.determinant() < 0;
                if (is_mirrored) turn_over(corners);
                Points places = x(Eigen::all, corners);
                result.push_back({shown, primitive, std::move(corners), std::move(places), is_mirrored});
              });
  return result;
}

std::vector<GltfLines> shown_lines(const GltfFile& file, const std::vector<GltfAccessor>& accessors,
                                   const GltfScene& scene) {
  std::vector<GltfLines> result;
  visit_shown(file, accessors, scene, read_lines,
              [&](std::size_t shown, std::size_t primitive, std::vector<std::uint32_t> ends,
                  const GltfPlacement&, const Points& x) {
                Points places = x(Eigen::all, ends);
                result.push_back({shown, primitive, std::move(ends), std::move(places)});
              });
  return result;
}

}  // namespace bespoke
