#include <array>
#include <cstring>
#include <numeric>
#include <string>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/product/detail/face_formats.h"
#include "bespoke/product/detail/gathered_faces.h"
#include "bespoke/product/detail/gltf_nodes.h"

namespace bespoke {
namespace {

// A primitive's `mode`; 5 is a strip, and points and lines below have no faces.
constexpr std::uint64_t triangles_mode = 4, fan_mode = 6;

std::vector<std::uint32_t> read_indices(const GltfAccessor& accessor, const GltfFile& file) {
  std::vector<std::uint32_t> indices(accessor.count, 0);
  const bool is_whole = accessor.component == GltfComponent::uint8 ||
                        accessor.component == GltfComponent::uint16 ||
                        accessor.component == GltfComponent::uint32;
  if (accessor.components != 1 || !is_whole || accessor.sparse)
    throw FormatError(file.path.string() + ": " + accessor.pointer +
                      ": indices of triangles must be whole numbers without a sign, and not sparse");
  if (!accessor.dense) return indices;
  const GltfPlace& place = *accessor.dense;
  const char* bytes = file.buffers[place.buffer].data() + place.offset;
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

class GltfFaces {
 public:
  explicit GltfFaces(const InputFile& file)
      : file_(read_gltf(file)), accessors_(read_accessors(file_)), gathered_(file.path()) {}

  Product read() {
    const GltfScene scene = read_scene(file_, accessors_);
    const std::vector<GltfPart> meshes = file_.root().elements("meshes");
    for (const GltfShown& shown : scene.shown)
      for (const GltfPart& primitive : meshes[shown.mesh].elements("primitives"))
        add(primitive, shown.scene_from_mesh);
    const Points corners = gathered_.product(false).vertices;
    if (corners.cols() == 0) throw FormatError(file_.path.string() + ": the scene shows no triangles");
    return joined_triangles(corners);
  }

 private:
  void add(const GltfPart& primitive, const AffineMap& scene_from_mesh) {
    const std::uint64_t mode = primitive.whole_or("mode", triangles_mode);
    if (mode < triangles_mode || mode > fan_mode) return;
    const auto positions = primitive.member("attributes").index("POSITION", accessors_.size());
    if (!positions) return;
    const GltfAccessor& vertices = accessors_[*positions];
    if (vertices.components != 3) primitive.fail("its positions are no VEC3");
    std::vector<std::uint32_t> indices(vertices.count);
    std::iota(indices.begin(), indices.end(), 0u);
    if (const auto own = primitive.index("indices", accessors_.size()))
      indices = read_indices(accessors_[*own], file_);
    for (const std::uint32_t index : indices)
      if (index >= vertices.count)
        primitive.fail("names vertex " + std::to_string(index) + " of " + std::to_string(vertices.count));
    indices = triangles(indices, mode);
    if (indices.size() % 3 != 0)
      primitive.fail(std::to_string(indices.size()) + " indices are no whole number of triangles");
    // A mirrored mesh shows its faces from behind.
    if (scene_from_mesh.linear.determinant() < 0)
      for (std::size_t i = 0; i < indices.size(); i += 3) std::swap(indices[i + 1], indices[i + 2]);
    const Points x =
        in_scene(scene_from_mesh, read_values(vertices, file_.buffers, 0, vertices.count).cast<double>());
    gathered_.add_points(x(Eigen::all, indices));
  }

  GltfFile file_;
  std::vector<GltfAccessor> accessors_;
  GatheredFaces gathered_;
};

}  // namespace

Product read_gltf_faces(const InputFile& file) { return GltfFaces(file).read(); }

}  // namespace bespoke
