#include "bespoke/exchange/glb_file.h"

#include <array>
#include <fstream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "bespoke/atomic_file.h"
#include "bespoke/error.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/product/morph_product.h"

namespace bespoke {
namespace {

using Json = nlohmann::ordered_json;
using PointsF = Eigen::Matrix3Xf;

// Of the glTF 2.0 specification.
constexpr int component_float = 5126;
constexpr int component_uint = 5125;
constexpr int target_vertices = 34962;
constexpr int target_indices = 34963;
constexpr std::size_t chunk_alignment = 4;
constexpr std::size_t headers_bytes = 12 + 8 + 8;

/// The vertices of the file: a vertex of the product once for every texture coordinate that it has.
struct Corners {
  std::vector<int> vertex;               ///< of the product
  std::vector<Eigen::Vector2d> texture;  ///< empty where the product has none
  std::vector<std::uint32_t> indices;    ///< three a triangle
};

/// Whether a triangle of these corners names a vertex twice.
bool is_degenerate(const Product& product, const std::array<int, 3>& triangle) {
  const auto vertex = [&](std::size_t k) { return product.corners[static_cast<std::size_t>(triangle[k])]; };
  return vertex(0) == vertex(1) || vertex(1) == vertex(2) || vertex(2) == vertex(0);
}

Corners corners_of(const Product& product) {
  Corners result;
  const bool has_texture = product.texture.cols() > 0;
  std::map<std::tuple<int, double, double>, std::uint32_t> numbers;
  const auto number = [&](int corner) {
    const int vertex = product.corners[static_cast<std::size_t>(corner)];
    const Eigen::Vector2d texture =
        has_texture ? Eigen::Vector2d(product.texture.col(corner)) : Eigen::Vector2d::Zero();
    const auto next = static_cast<std::uint32_t>(result.vertex.size());
    const auto [entry, is_new] = numbers.try_emplace({vertex, texture.x(), texture.y()}, next);
    if (is_new) {
      result.vertex.push_back(vertex);
      if (has_texture) result.texture.push_back(texture);
    }
    return entry->second;
  };
  for (std::size_t p = 0; p + 1 < product.polygon_start.size(); ++p)
    for (int k = product.polygon_start[p] + 2; k < product.polygon_start[p + 1]; ++k)
      if (!is_degenerate(product, {product.polygon_start[p], k - 1, k}))
        for (const int corner : {product.polygon_start[p], k - 1, k})
          result.indices.push_back(number(corner));
  return result;
}

/// JSON and bytes of the one buffer, which grow together.
class GlbBuilder {
 public:
  Json root = {{"asset", {{"version", "2.0"}, {"generator", "bespoke"}}}};

  int floats(const float* values, std::size_t count, int components, bool of_vertices) {
    static constexpr std::array types{"SCALAR", "VEC2", "VEC3"};
    return accessor(values, sizeof(float), count, components, component_float,
                    types[static_cast<std::size_t>(components) - 1], of_vertices ? target_vertices : 0);
  }
  /// With the bounds that positions must state.
  int positions(const PointsF& x) {
    const int number = floats(x.data(), static_cast<std::size_t>(x.cols()), 3, true);
    Json& own = root["accessors"][static_cast<std::size_t>(number)];
    const Eigen::Vector3f low = x.rowwise().minCoeff(), high = x.rowwise().maxCoeff();
    own["min"] = {low.x(), low.y(), low.z()};
    own["max"] = {high.x(), high.y(), high.z()};
    return number;
  }
  int vectors(const PointsF& x) { return floats(x.data(), static_cast<std::size_t>(x.cols()), 3, true); }
  int indices(const std::vector<std::uint32_t>& values) {
    return accessor(values.data(), sizeof(std::uint32_t), values.size(), 1, component_uint, "SCALAR",
                    target_indices);
  }

  std::string bytes() {
    root["buffers"] = {{{"byteLength", data_.size()}}};
    std::string text = root.dump();
    text.resize((text.size() + chunk_alignment - 1) / chunk_alignment * chunk_alignment, ' ');
    const std::size_t size = headers_bytes + text.size() + data_.size();
    if (size > std::numeric_limits<std::uint32_t>::max())
      throw InvalidInput(std::to_string(size) + " bytes do not fit a .glb; fewer --morph targets do");
    return "glTF" + word(2) + word(size) + word(text.size()) + "JSON" + text + word(data_.size()) +
           std::string("BIN\0", 4) + data_;
  }

 private:
  static std::string word(std::size_t value) {
    const auto number = static_cast<std::uint32_t>(value);
    return {reinterpret_cast<const char*>(&number), sizeof number};
  }

  int accessor(const void* values, std::size_t value_bytes, std::size_t count, int components, int component,
               const char* type, int target) {
    const std::size_t length = count * static_cast<std::size_t>(components) * value_bytes;
    Json view = {{"buffer", 0}, {"byteOffset", data_.size()}, {"byteLength", length}};
    if (target) view["target"] = target;
    root["bufferViews"].push_back(view);
    data_.append(static_cast<const char*>(values), length);
    root["accessors"].push_back({{"bufferView", root["bufferViews"].size() - 1},
                                 {"componentType", component},
                                 {"count", count},
                                 {"type", type}});
    return static_cast<int>(root["accessors"].size()) - 1;
  }

  std::string data_;
};

PointsF picked(const Points& points, const std::vector<int>& columns) {
  return points(Eigen::all, columns).cast<float>();
}

/// Unit normals of vertices; where there is none, any, for glTF requires one.
Points normals_of(const Product& product, const Points& vertices) {
  Points normals = vertex_normals({vertices, triangulated(product)});
  for (Eigen::Index i = 0; i < normals.cols(); ++i)
    if (normals.col(i).isZero()) normals.col(i) = Vector3::UnitZ();
  return normals;
}

Json primitive_of(GlbBuilder& builder, const MorphingMesh& mesh, const Corners& corners) {
  const Product& product = mesh.product;
  Json primitive;
  const PointsF x = picked(product.vertices, corners.vertex);
  primitive["attributes"]["POSITION"] = builder.positions(x);
  const Points normals = product.has_normals ? normals_of(product, product.vertices) : Points();
  if (product.has_normals)
    primitive["attributes"]["NORMAL"] = builder.vectors(picked(normals, corners.vertex));
  if (!corners.texture.empty()) {
    // glTF's v runs down the image, OBJ's and PLY's up.
    std::vector<float> uv;
    for (const Eigen::Vector2d& at : corners.texture) {
      uv.push_back(static_cast<float>(at.x()));
      uv.push_back(static_cast<float>(1 - at.y()));
    }
    primitive["attributes"]["TEXCOORD_0"] = builder.floats(uv.data(), corners.texture.size(), 2, true);
  }
  primitive["indices"] = builder.indices(corners.indices);
  for (const Points& target : mesh.targets) {
    Json entry;
    entry["POSITION"] = builder.positions(picked(target, corners.vertex) - x);
    if (product.has_normals)
      entry["NORMAL"] = builder.vectors(picked(normals_of(product, target) - normals, corners.vertex));
    primitive["targets"].push_back(entry);
  }
  return primitive;
}

Json animation_of(GlbBuilder& builder, const MorphTrack& track) {
  const int input = builder.floats(track.times.data(), track.times.size(), 1, false);
  builder.root["accessors"].back()["min"] = {track.times.front()};
  builder.root["accessors"].back()["max"] = {track.times.back()};
  const int output = builder.floats(track.weights.data(), track.weights.size(), 1, false);
  return {{"name", "t from 0 to 1"},
          {"samplers", {{{"input", input}, {"output", output}, {"interpolation", "LINEAR"}}}},
          {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}};
}

}  // namespace

void write_glb(const std::filesystem::path& path, const MorphingMesh& mesh, const GlbNotes& notes) {
  const MorphTrack track = morph_track(mesh.targets.size(), notes.seconds);
  GlbBuilder builder;
  Json primitive = primitive_of(builder, mesh, corners_of(mesh.product));
  Json animation = animation_of(builder, track);
  builder.root["meshes"] = {{{"name", notes.name},
                             {"primitives", {std::move(primitive)}},
                             {"weights", std::vector<int>(track.names.size())},
                             {"extras", {{"targetNames", track.names}}}}};
  Json node = {{"name", notes.name}, {"mesh", 0}};
  if (const double scale = notes.metres_per_unit.value_or(1); scale != 1)
    node["scale"] = {scale, scale, scale};
  builder.root["nodes"] = {std::move(node)};
  builder.root["scenes"] = {{{"nodes", {0}}}};
  builder.root["scene"] = 0;
  builder.root["animations"] = {std::move(animation)};
  const std::string bytes = builder.bytes();
  write_atomically(path, [&](const std::filesystem::path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.flush();
    if (!out) throw FileError(path.string() + ": cannot be written");
  });
}

}  // namespace bespoke
