#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/product/carry/product_formats.h"
#include "bespoke/product/faces/face_parts.h"
#include "bespoke/product/faces/gathered_faces.h"
#include "bespoke/product/gltf/document/gltf_additions.h"
#include "bespoke/product/gltf/gltf_split_lines.h"
#include "bespoke/product/gltf/scene/gltf_plan.h"

namespace bespoke {
namespace {

constexpr const char* uri_of_added_buffer = "data:application/gltf-buffer;base64,";
// A primitive's `mode`.
constexpr std::uint64_t list_of_lines = 1, loop_of_lines = 2, list_of_triangles = 4;

/// A primitive that has triangles or lines that are split.
struct SplitPrimitive {
  std::size_t primitive = 0;
  std::size_t vertices = 0;            ///< in the mesh
  std::vector<std::uint32_t> corners;  ///< three a triangle, as the primitive has its front; lines by `mode`
  std::uint64_t mode = list_of_triangles;
  bool operator==(const SplitPrimitive&) const = default;
};

struct SplitMesh {
  std::vector<SplitVertices> vertices;
  std::vector<SplitPrimitive> primitives;
  std::size_t result = 0;  ///< the mesh that is written

  bool operator==(const SplitMesh& other) const {
    return vertices == other.vertices && primitives == other.primitives;
  }
};

/// How often a file refers to its accessors and, under "bufferView", to its views.
struct GltfUses {
  std::vector<std::size_t> accessors, views;

  explicit GltfUses(const GltfFile& file)
      : accessors(file.root().elements("accessors").size()),
        views(file.root().elements("bufferViews").size()) {
    for (const GltfPart& mesh : file.root().elements("meshes"))
      for (const GltfPart& primitive : mesh.elements("primitives")) {
        add(primitive, "indices");
        for (const GltfPart& list : lists_of(primitive))
          for (const std::string& name : list.names()) add(list, name.c_str());
      }
    for (const GltfPart& skin : file.root().elements("skins")) add(skin, "inverseBindMatrices");
    for (const GltfPart& animation : file.root().elements("animations"))
      for (const GltfPart& sampler : animation.elements("samplers"))
        for (const char* key : {"input", "output"}) add(sampler, key);
    add_views(file.json);
  }

  /// The attributes and the morph targets.
  static std::vector<GltfPart> lists_of(const GltfPart& primitive) {
    std::vector<GltfPart> lists = primitive.elements("targets");
    lists.push_back(primitive.member("attributes"));
    return lists;
  }

 private:
  void add(const GltfPart& part, const char* key) {
    if (const auto index = part.index(key, accessors.size())) ++accessors[*index];
  }
  void add_views(const GltfJson& value) {
    if (!value.is_structured()) return;
    for (const auto& [key, member] : value.items()) {
      const bool is_view = value.is_object() && key == "bufferView" && member.is_number_unsigned();
      if (is_view && member.get<std::size_t>() < views.size()) ++views[member.get<std::size_t>()];
      add_views(member);
    }
  }
};

class GltfSplitter {
 public:
  GltfSplitter(GltfFile& file, const FaceSplits& splits, ModelPose pose)
      : file_(file),
        accessors_(read_accessors(file)),
        scene_(read_scene(file, accessors_, pose)),
        triangles_(shown_triangles(file, accessors_, scene_)),
        lines_(shown_lines(file, accessors_, scene_)),
        split_lines_(triangles_, lines_, splits),
        parts_(splits, count_polygons(), file.path),
        meshes_(file.root().elements("meshes")),
        uses_(file),
        is_ours_(accessors_.size()),
        json_(file.json) {}

  /// A mesh that is shown at several places becomes several where it is not split alike at all of them.
  void run() {
    std::vector<std::vector<SplitMesh>> known(meshes_.size());
    for (std::size_t shown = 0; shown < scene_.shown.size(); ++shown) {
      const std::size_t mesh = scene_.shown[shown].mesh;
      SplitMesh split = split_mesh(shown);
      auto& own = known[mesh];
      auto found = std::find(own.begin(), own.end(), split);
      if (found == own.end()) {
        split.result = own.empty() ? mesh : copy(mesh);
        found = own.insert(own.end(), std::move(split));
      }
      if (found->result != mesh) json_["nodes"][scene_.shown[shown].node]["mesh"] = found->result;
    }
    for (std::size_t mesh = 0; mesh < meshes_.size(); ++mesh) {
      if (known[mesh].size() == 1) note_own_accessors(known[mesh].front(), mesh);
      for (const SplitMesh& split : known[mesh]) write(split, mesh);
    }
    if (buffer_) drop_bytes_without_view(file_, json_, *buffer_);
    if (buffer_ && json_["buffers"][*buffer_].contains("uri")) {
      GltfJson& uri = json_["buffers"][*buffer_]["uri"];
      uri = data_uri_of(uri.get<std::string>(), file_.buffers[*buffer_].content());
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
    for (; line_at_ < lines_.size() && lines_[line_at_].shown == shown; ++line_at_) {
      const std::size_t begin = edge_;
      edge_ += lines_[line_at_].ends.size() / 2;
      bool is_split = false;
      for (std::size_t edge = begin; edge < edge_; ++edge) is_split = is_split || split_lines_.is_split(edge);
      if (is_split) split(lines_[line_at_], begin, mesh);
    }
    return mesh;
  }

  /// Loops and strips stay such.
  void split(const GltfLines& lines, std::size_t edge, SplitMesh& mesh) const {
    const std::size_t of_mesh = scene_.shown[lines.shown].mesh;
    const GltfPart primitive = meshes_[of_mesh].elements("primitives")[lines.primitive];
    SplitPrimitive result{lines.primitive, vertices_of(lines.primitive, of_mesh, mesh), {}};
    result.mode = primitive.whole_or("mode", list_of_lines);
    for (std::size_t i = 0; i < lines.ends.size(); i += 2, ++edge) {
      std::uint32_t before = lines.ends[i];
      if (result.mode != list_of_lines && i == 0) result.corners.push_back(before);
      for (const std::uint32_t behind :
           split_lines_.chain(edge, before, lines.ends[i + 1], mesh.vertices[result.vertices])) {
        if (result.mode == list_of_lines) result.corners.push_back(before);
        result.corners.push_back(before = behind);
      }
    }
    if (result.mode == loop_of_lines) result.corners.pop_back();
    mesh.primitives.push_back(std::move(result));
  }

  void split(const GltfTriangles& triangles, const std::vector<std::size_t>& kept, std::size_t polygon,
             SplitMesh& mesh) const {
    const GltfShown& shown = scene_.shown[triangles.shown];
    SplitPrimitive result{triangles.primitive, vertices_of(triangles.primitive, shown.mesh, mesh), {}};
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
    if (triangles.is_mirrored) turn_over(result.corners);
    mesh.primitives.push_back(std::move(result));
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

  /// Notes the accessors that nothing but the split primitives of the mesh uses.
  void note_own_accessors(const SplitMesh& split, std::size_t mesh) {
    const std::vector<GltfPart> primitives = meshes_[mesh].elements("primitives");
    const auto note = [&](const GltfPart& part, const std::string& key, std::size_t uses) {
      const auto index = part.index(key.c_str(), accessors_.size());
      if (index && uses_.accessors[*index] == uses) is_ours_[*index] = true;
    };
    for (const SplitPrimitive& own : split.primitives) {
      const auto shares = [&](const SplitPrimitive& other) { return other.vertices == own.vertices; };
      const auto users = std::count_if(split.primitives.begin(), split.primitives.end(), shares);
      const GltfPart& primitive = primitives[own.primitive];
      note(primitive, "indices", 1);
      for (const GltfPart& list : GltfUses::lists_of(primitive))
        for (const std::string& name : list.names()) note(list, name, static_cast<std::size_t>(users));
    }
  }

  void write(const SplitMesh& split, std::size_t mesh) {
    const std::vector<GltfPart> primitives = meshes_[mesh].elements("primitives");
    std::vector<GltfJson> lists;
    for (const SplitVertices& vertices : split.vertices)
      lists.push_back(stored_lists(primitives[vertices.primitive], vertices.middles));
    for (const SplitPrimitive& own : split.primitives) {
      GltfJson now = file_.json["meshes"][mesh]["primitives"][own.primitive];
      now.update(lists[own.vertices]);
      now["indices"] =
          store_indices(primitives[own.primitive].index("indices", accessors_.size()), own.corners);
      if (now.contains("mode")) now["mode"] = own.mode;
      json_["meshes"][split.result]["primitives"][own.primitive] = std::move(now);
    }
  }

  /// The attributes and morph targets with values of the middles as well.
  GltfJson stored_lists(const GltfPart& primitive, const GltfMiddles& middles) {
    const GltfPart attributes = primitive.member("attributes");
    const GltfVertexDataByName vertex_data =
        middle_attributes(attributes, accessors_, file_.buffers, middles);
    GltfJson lists;
    lists["attributes"] = stored_list(attributes, vertex_data);
    for (const GltfPart& target : primitive.elements("targets"))
      lists["targets"].push_back(
          stored_list(target, middle_differences(target, vertex_data, accessors_, file_.buffers, middles)));
    return lists;
  }

  GltfJson stored_list(const GltfPart& list, const GltfVertexDataByName& vertex_data) {
    GltfJson result = GltfJson::object();
    for (const std::string& name : list.names())
      result[name] = store(*list.index(name.c_str(), accessors_.size()), vertex_data.at(name));
    return result;
  }

  /// As the accessor `source` except for its values.
  std::size_t store(std::size_t source, const GltfVertexData& vertex_data) {
    const bool is_normalized = vertex_data.is_normalized && vertex_data.component != GltfComponent::real;
    const GltfPlace place = add_view(json_, file_.buffers,
                                     {vertex_data.component, is_normalized, accessors_[source].components,
                                      static_cast<std::size_t>(vertex_data.values.cols()), buffer()},
                                     GltfTarget::vertices);
    file_.buffers[place.buffer].replace(rows_of_values(place, vertex_data.values));
    GltfJson accessor = file_.json["accessors"][source];
    if (!is_normalized) accessor.erase("normalized");
    update_bounds(accessor, vertex_data.component, is_normalized, vertex_data.values);
    return store(source, std::move(accessor), place);
  }

  std::size_t store_indices(std::optional<std::size_t> source, const std::vector<std::uint32_t>& corners) {
    // The largest number of a type restarts strips.
    const std::uint32_t largest = *std::max_element(corners.begin(), corners.end());
    const GltfComponent least = largest < 255     ? GltfComponent::uint8
                                : largest < 65535 ? GltfComponent::uint16
                                                  : GltfComponent::uint32;
    const GltfComponent own = source ? accessors_[*source].component : GltfComponent::uint16;
    const GltfPlace place =
        add_view(json_, file_.buffers, {std::max(own, least), false, 1, corners.size(), buffer()},
                 GltfTarget::indices);
    std::string packed;
    packed.reserve(corners.size() * place.vector_size());
    for (const std::uint32_t corner : corners)  // the low bytes come first
      packed.append(reinterpret_cast<const char*>(&corner), place.vector_size());
    file_.buffers[place.buffer].replace(place.rows(std::move(packed)));
    GltfJson accessor = source ? file_.json["accessors"][*source] : GltfJson{{"type", "SCALAR"}};
    for (const char* key : {"min", "max"}) accessor.erase(key);
    return store(source, std::move(accessor), place);
  }

  /// Gives the accessor the values in the view that was added last: `source` itself, or a further one.
  std::size_t store(std::optional<std::size_t> source, GltfJson accessor, const GltfPlace& place) {
    const bool is_ours = source && is_ours_[*source];
    accessor.erase("sparse");
    if (accessor.contains("byteOffset")) accessor["byteOffset"] = 0;
    accessor["bufferView"] = is_ours ? view_instead_of(accessors_[*source]) : json_["bufferViews"].size() - 1;
    accessor["componentType"] = static_cast<int>(place.component);
    accessor["count"] = place.count;
    if (is_ours) {
      json_["accessors"][*source] = std::move(accessor);
      return *source;
    }
    json_["accessors"].push_back(std::move(accessor));
    return json_["accessors"].size() - 1;
  }

  /// The view that was added last takes the place of the accessor's, unless that still has other uses.
  std::size_t view_instead_of(const GltfAccessor& accessor) {
    GltfJson& views = json_["bufferViews"];
    if (!accessor.dense) return views.size() - 1;
    const std::size_t own = file_.json[GltfJson::json_pointer(accessor.pointer)]["bufferView"];
    if (--uses_.views[own] > 0) return views.size() - 1;
    const GltfJson added = views.back();
    views.erase(views.size() - 1);
    if (!added.contains("byteStride")) views[own].erase("byteStride");
    views[own].update(added);
    return own;
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
  std::vector<GltfLines> lines_;
  SplitLines split_lines_;
  std::vector<std::vector<std::size_t>> kept_;  ///< of these, by their places, those that are polygons
  FaceParts parts_;
  std::vector<GltfPart> meshes_;
  GltfUses uses_;
  std::vector<bool> is_ours_;  ///< of every accessor: whether what is written now is its only use
  GltfJson json_;
  std::size_t at_ = 0, polygon_ = 0;    ///< the next of the triangles and of the polygons
  std::size_t line_at_ = 0, edge_ = 0;  ///< the next of the lines and of their edges
  std::optional<std::size_t> buffer_;   ///< once there are new values
};

void split_in(ModelPose pose, const InputFile& input, const FaceSplits& splits, OutputFile& output) {
  GltfFile file = read_gltf(input);
  const GltfPlan plan =
      plan_gltf(file, read_accessors(file), pose);  // refuses what could not be carried afterwards
  for (const GltfPlacement& place : plan.places)
    if (!place.of_vertices.empty())
      throw InvalidInput(input.path().string() +
                         ": shows a skinned mesh in another pose than its bind pose, in which edges are not "
                         "split; take it as it is stored (--pose stored), or export it without its skin");
  GltfSplitter splitter(file, splits, pose);
  splitter.run();
  write_gltf(file, splitter.text(), file.buffers.front(), output);
}

}  // namespace

void split_gltf(const InputFile& input, const FaceSplits& splits, OutputFile& output) {
  split_in(ModelPose::shown, input, splits, output);
}

void split_stored_gltf(const InputFile& input, const FaceSplits& splits, OutputFile& output) {
  split_in(ModelPose::stored, input, splits, output);
}

}  // namespace bespoke
