#include <algorithm>
#include <cstring>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/product/detail/face_parts.h"
#include "bespoke/product/detail/gathered_faces.h"
#include "bespoke/product/detail/gltf_additions.h"
#include "bespoke/product/detail/gltf_middles.h"
#include "bespoke/product/detail/gltf_plan.h"
#include "bespoke/product/detail/gltf_triangles.h"
#include "bespoke/product/detail/product_formats.h"

namespace bespoke {
namespace {

constexpr const char* uri_of_added_buffer = "data:application/gltf-buffer;base64,";
constexpr int list_of_triangles = 4;  // a primitive's `mode`

/// Vertices that primitives of a mesh share, and those between them.
struct SplitVertices {
  std::size_t primitive = 0;  ///< the first one
  GltfMiddles middles;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> between = {};  ///< by their ends

  std::uint32_t middle(std::uint32_t a, std::uint32_t b) {
    const auto [found, is_new] =
        between.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(middles.count()));
    if (is_new) middles.ends.push_back(found->first);
    return found->second;
  }
  bool operator==(const SplitVertices& other) const {
    return primitive == other.primitive && middles == other.middles;
  }
};

/// The triangles of a primitive that has some that are split.
struct SplitTriangles {
  std::size_t primitive = 0;
  std::size_t vertices = 0;            ///< in the mesh
  std::vector<std::uint32_t> corners;  ///< three a triangle, as the primitive has its front
  bool operator==(const SplitTriangles&) const = default;
};

struct SplitMesh {
  std::vector<SplitVertices> vertices;
  std::vector<SplitTriangles> triangles;
  bool operator==(const SplitMesh&) const = default;
};

class GltfSplitter {
 public:
  GltfSplitter(GltfFile& file, const FaceSplits& splits)
      : file_(file),
        accessors_(read_accessors(file)),
        scene_(read_scene(file, accessors_)),
        triangles_(shown_triangles(file, accessors_, scene_)),
        parts_(splits, count_polygons(), file.path),
        meshes_(file.root().elements("meshes")),
        json_(file.json) {}

  /// A mesh that is shown at several places becomes several where it is not split alike at all of them.
  void run() {
    std::vector<std::vector<std::pair<SplitMesh, std::size_t>>> known(meshes_.size());  // and where it is
    for (std::size_t shown = 0; shown < scene_.shown.size(); ++shown) {
      const std::size_t mesh = scene_.shown[shown].mesh;
      SplitMesh split = split_mesh(shown);
      auto& own = known[mesh];
      auto found =
          std::find_if(own.begin(), own.end(), [&](const auto& pair) { return pair.first == split; });
      if (found == own.end()) {
        own.emplace_back(std::move(split), own.empty() ? mesh : copy(mesh));
        found = own.end() - 1;
        write(found->first, mesh, found->second);
      }
      if (found->second != mesh) json_["nodes"][scene_.shown[shown].node]["mesh"] = found->second;
    }
    if (buffer_ && json_["buffers"][*buffer_].contains("uri")) {
      GltfJson& uri = json_["buffers"][*buffer_]["uri"];
      uri = data_uri_of(uri.get<std::string>(), file_.buffers[*buffer_]);
    }
  }

  std::string text() const { return edited_json(file_.text, file_.json, json_); }

 private:
  /// Triangles that read_product leaves out, since corners coincide, are no polygons, and stay as they are.
  std::size_t count_polygons() {
    std::size_t polygons = 0;
    for (const GltfTriangles& triangles : triangles_) {
      kept_.push_back(kept_triangles(triangles.places));
      polygons += kept_.back().size();
    }
    return polygons;
  }

  SplitMesh split_mesh(std::size_t shown) {
    SplitMesh mesh;
    for (; at_ < triangles_.size() && triangles_[at_].shown == shown; ++at_) {
      const std::size_t begin = polygon_;
      polygon_ += kept_[at_].size();
      bool is_split = false;
      for (std::size_t p = begin; p < polygon_; ++p) is_split = is_split || parts_.is_split(p);
      if (is_split) split(triangles_[at_], kept_[at_], begin, mesh);
    }
    return mesh;
  }

  void split(const GltfTriangles& triangles, const std::vector<std::size_t>& kept, std::size_t polygon,
             SplitMesh& mesh) const {
    const GltfShown& shown = scene_.shown[triangles.shown];
    SplitTriangles result{triangles.primitive, vertices_of(triangles.primitive, shown.mesh, mesh), {}};
    SplitVertices& vertices = mesh.vertices[result.vertices];
    const auto middle = [&](std::uint32_t a, std::uint32_t b, int) { return vertices.middle(a, b); };
    auto next = kept.begin();
    for (std::size_t i = 0; i < triangles.corners.size() / 3; ++i) {
      const auto first = triangles.corners.begin() + static_cast<std::ptrdiff_t>(3 * i);
      const std::vector<std::uint32_t> own(first, first + 3);
      const bool is_polygon = next != kept.end() && *next == i;
      next += is_polygon;
      if (!is_polygon || !parts_.is_split(polygon++))
        result.corners.insert(result.corners.end(), own.begin(), own.end());
      else
        for (const std::vector<std::uint32_t>& part : parts_.parts(polygon - 1, own, middle))
          result.corners.insert(result.corners.end(), part.begin(), part.end());
    }
    if (is_mirrored(shown.scene_from_mesh)) turn_over(result.corners);
    mesh.triangles.push_back(std::move(result));
  }

  /// The vertices in the mesh, new ones unless a primitive with the same lists has some.
  std::size_t vertices_of(std::size_t primitive, std::size_t mesh, SplitMesh& split) const {
    const GltfJson& primitives = file_.json["meshes"][mesh]["primitives"];
    const auto same = [&](const SplitVertices& vertices) {
      const GltfJson &a = primitives[primitive], &b = primitives[vertices.primitive];
      return a["attributes"] == b["attributes"] &&
             a.value("targets", GltfJson()) == b.value("targets", GltfJson());
    };
    const auto found = std::find_if(split.vertices.begin(), split.vertices.end(), same);
    const auto index = static_cast<std::size_t>(found - split.vertices.begin());
    if (found != split.vertices.end()) return index;
    const std::size_t positions = primitives[primitive]["attributes"]["POSITION"].get<std::size_t>();
    split.vertices.push_back({primitive, {accessors_[positions].count, {}}});
    return index;
  }

  std::size_t copy(std::size_t mesh) {
    GltfJson element = file_.json["meshes"][mesh];
    json_["meshes"].push_back(std::move(element));
    return json_["meshes"].size() - 1;
  }

  void write(const SplitMesh& split, std::size_t mesh, std::size_t result) {
    const std::vector<GltfPart> primitives = meshes_[mesh].elements("primitives");
    std::vector<GltfJson> lists;
    for (const SplitVertices& vertices : split.vertices)
      lists.push_back(added_lists(primitives[vertices.primitive], vertices.middles));
    for (const SplitTriangles& triangles : split.triangles) {
      GltfJson now = file_.json["meshes"][mesh]["primitives"][triangles.primitive];
      now.update(lists[triangles.vertices]);
      now["indices"] =
          add_indices(primitives[triangles.primitive].index("indices", accessors_.size()), triangles.corners);
      if (now.contains("mode")) now["mode"] = list_of_triangles;
      json_["meshes"][result]["primitives"][triangles.primitive] = std::move(now);
    }
  }

  /// The attributes and morph targets with values of the middles as well.
  GltfJson added_lists(const GltfPart& primitive, const GltfMiddles& middles) {
    const GltfPart attributes = primitive.member("attributes");
    const GltfSaidByName said = middle_attributes(attributes, accessors_, file_.buffers, middles);
    GltfJson lists;
    lists["attributes"] = added_list(attributes, said);
    for (const GltfPart& target : primitive.elements("targets"))
      lists["targets"].push_back(
          added_list(target, middle_differences(target, said, accessors_, file_.buffers, middles)));
    return lists;
  }

  GltfJson added_list(const GltfPart& list, const GltfSaidByName& said) {
    GltfJson result;
    for (const std::string& name : list.names())
      result[name] = add_accessor(*list.index(name.c_str(), accessors_.size()), said.at(name));
    return result;
  }

  /// As the accessor `source` but for its values.
  std::size_t add_accessor(std::size_t source, const GltfSaid& said) {
    const bool is_normalized = said.is_normalized && said.component != GltfComponent::real;
    const GltfPlace place = add_view(json_, file_.buffers,
                                     {said.component, is_normalized, accessors_[source].components,
                                      static_cast<std::size_t>(said.values.cols()), buffer()},
                                     GltfTarget::vertices);
    store_values(place, 0, said.values, file_.buffers[place.buffer]);
    GltfJson accessor = file_.json["accessors"][source];
    if (!is_normalized) accessor.erase("normalized");
    update_bounds(accessor, said.component, is_normalized, said.values);
    return add_accessor(std::move(accessor), place);
  }

  std::size_t add_indices(std::optional<std::size_t> source, const std::vector<std::uint32_t>& corners) {
    // The largest number of a type restarts strips.
    const std::uint32_t largest = *std::max_element(corners.begin(), corners.end());
    const GltfComponent least = largest < 255     ? GltfComponent::uint8
                                : largest < 65535 ? GltfComponent::uint16
                                                  : GltfComponent::uint32;
    const GltfComponent own = source ? accessors_[*source].component : GltfComponent::uint16;
    const GltfPlace place =
        add_view(json_, file_.buffers, {std::max(own, least), false, 1, corners.size(), buffer()},
                 GltfTarget::indices);
    char* to = file_.buffers[place.buffer].data() + place.offset;
    for (const std::uint32_t corner : corners) {
      std::memcpy(to, &corner, place.vector_size());  // the low bytes come first
      to += place.stride;
    }
    GltfJson accessor = source ? file_.json["accessors"][*source] : GltfJson{{"type", "SCALAR"}};
    for (const char* key : {"min", "max"}) accessor.erase(key);
    return add_accessor(std::move(accessor), place);
  }

  /// Of the values in the view that was added last.
  std::size_t add_accessor(GltfJson accessor, const GltfPlace& place) {
    for (const char* key : {"sparse", "byteOffset"}) accessor.erase(key);
    accessor["bufferView"] = json_["bufferViews"].size() - 1;
    accessor["componentType"] = static_cast<int>(place.component);
    accessor["count"] = place.count;
    json_["accessors"].push_back(std::move(accessor));
    return json_["accessors"].size() - 1;
  }

  /// The one that new values go to: the first, or one in the JSON where that is a file of its own.
  std::size_t buffer() {
    if (buffer_) return *buffer_;
    const GltfPart first = file_.root().elements("buffers").front();
    buffer_ = 0;
    if (first.has("uri") && !is_data_uri(first.text("uri"))) {
      buffer_ = file_.buffers.size();
      file_.buffers.emplace_back();
      json_["buffers"].push_back({{"byteLength", 0}, {"uri", uri_of_added_buffer}});
    }
    return *buffer_;
  }

  GltfFile& file_;
  std::vector<GltfAccessor> accessors_;
  GltfScene scene_;
  std::vector<GltfTriangles> triangles_;
  std::vector<std::vector<std::size_t>> kept_;  ///< of these, by their places, those that are polygons
  FaceParts parts_;
  std::vector<GltfPart> meshes_;
  GltfJson json_;
  std::size_t at_ = 0, polygon_ = 0;   ///< the next of the triangles and of the polygons
  std::optional<std::size_t> buffer_;  ///< once there are new values
};

}  // namespace

void split_gltf(const InputFile& input, const FaceSplits& splits, OutputFile& output) {
  GltfFile file = read_gltf(input);
  plan_gltf(file, read_accessors(file));  // refuses what could not be carried afterwards
  GltfSplitter splitter(file, splits);
  splitter.run();
  write_gltf(file, splitter.text(), file.buffers.front(), output);
}

}  // namespace bespoke
