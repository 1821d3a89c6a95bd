#include "bespoke/pattern/seam_file.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "bespoke/error.h"
#include "bespoke/json_reason.h"
#include "bespoke/mesh/surface_paths.h"
#include "bespoke/text_lines.h"

namespace bespoke {
namespace {

using Json = nlohmann::json;

class SeamReader {
 public:
  SeamReader(std::string path, const TriangleMesh& mesh) : path_(std::move(path)), mesh_(mesh) {}

  SeamFile run(const Json& root) {
    if (!root.is_object()) fail("it must hold one object with \"seams\"");
    require_keys(root, {"seams", "pieces", "widths"}, "the file");
    if (!root.contains("seams") || !root["seams"].is_array()) fail("\"seams\" must be a list");
    for (const Json& seam : root["seams"]) add_seam(seam);
    file_.names = vertex_names(root, "pieces", "piece");
    file_.widths = vertex_names(root, "widths", "width");
    return std::move(file_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw FormatError(path_ + ": " + what); }

  void require_keys(const Json& object, const std::vector<std::string>& known,
                    const std::string& where) const {
    for (const auto& [key, value] : object.items())
      if (std::find(known.begin(), known.end(), key) == known.end())
        fail(where + " has the key \"" + key + "\", which means nothing here");
  }

  int vertex(const Json& value, const std::string& where) const {
    if (!value.is_number_integer()) fail(where + ": " + value.dump() + " is no number of a vertex");
    const auto number = value.get<long long>();
    if (number < 1 || number > mesh_.vertices.cols())
      fail(where + ": vertex " + std::to_string(number) + " is none of 1 … " +
           std::to_string(mesh_.vertices.cols()));
    return static_cast<int>(number - 1);
  }

  void add_seam(const Json& seam) {
    const std::string where = "seam " + std::to_string(file_.cuts.size() + 1);
    if (!seam.is_object()) fail(where + R"( must be an object with "edges", "path" or "line")");
    require_keys(seam, {"edges", "path", "line", "name", "ease", "longer"}, where);
    if (seam.count("edges") + seam.count("path") + seam.count("line") != 1)
      fail(where + R"( needs one of "edges", "path" and "line")");
    const std::string kind = seam.contains("edges") ? "edges" : seam.contains("path") ? "path" : "line";
    const Json& list = seam[kind];
    if (!list.is_array() || list.empty()) fail(where + " must be a list that is not empty");
    if (kind != "edges" && list.size() < 2) fail(where + ": a " + kind + " has two vertices or more");
    SeamCut cut;
    for (std::size_t k = 0; k < list.size(); ++k) {
      if (kind == "line")
        cut.line.push_back(edge_point(list[k], where));
      else if (kind == "edges")
        cut.edges.push_back(edge(list[k], where));
      else if (k > 0)
        add_way(vertex(list[k - 1], where), vertex(list[k], where), where, cut);
    }
    set_ease(seam, where, cut);
    file_.cuts.push_back(std::move(cut));
  }

  std::array<int, 2> edge(const Json& value, const std::string& where) const {
    if (!value.is_array() || value.size() != 2) fail(where + ": an edge is a pair of vertices");
    return {vertex(value[0], where), vertex(value[1], where)};
  }

  EdgePoint edge_point(const Json& value, const std::string& where) const {
    if (!value.is_array()) return {vertex(value, where), vertex(value, where), 0};
    if (value.size() != 3 || !value[2].is_number())
      fail(where + ": a point of a line is a vertex, or two vertices and the share of the way between them");
    const EdgePoint point{vertex(value[0], where), vertex(value[1], where), value[2].get<double>()};
    if (!(point.share >= 0 && point.share <= 1))
      fail(where + ": share " + value[2].dump() + " is not in 0 … 1");
    return point;
  }

  void set_ease(const Json& seam, const std::string& where, SeamCut& cut) const {
    if (seam.contains("ease") != seam.contains("longer"))
      fail(where + R"( needs "ease" and "longer" both, or neither)");
    if (!seam.contains("ease")) return;
    if (!seam["ease"].is_number() || !(seam["ease"].get<double>() >= 0))
      fail(where + ": \"ease\" must be millimetres, 0 or more");
    if (!seam["longer"].is_string()) fail(where + ": \"longer\" must name a piece");
    cut.ease = seam["ease"].get<double>();
    cut.longer = seam["longer"].get<std::string>();
  }

  /// From the end back along edges that the distance grows by exactly.
  void add_way(int from, int to, const std::string& where, SeamCut& cut) {
    if (!graph_) graph_ = edge_graph(mesh_);
    const PathStart start{from, 0};
    const Eigen::VectorXd distance = path_lengths(*graph_, {&start, 1});
    if (!std::isfinite(distance[to]))
      fail(where + ": no way over edges leads from vertex " + std::to_string(from + 1) + " to " +
           std::to_string(to + 1));
    for (int at = to; at != from;) {
      int before = at;
      double shortest = std::numeric_limits<double>::infinity();
      for (int k = graph_->start[static_cast<std::size_t>(at)];
           k < graph_->start[static_cast<std::size_t>(at) + 1]; ++k) {
        const int other = graph_->neighbours[static_cast<std::size_t>(k)];
        const double whole = distance[other] + graph_->lengths[static_cast<std::size_t>(k)];
        if (whole < shortest && distance[other] < distance[at]) shortest = whole, before = other;
      }
      if (before == at)
        fail(where + ": vertices " + std::to_string(at + 1) + " and its neighbours lie at one place");
      cut.edges.push_back({before, at});
      at = before;
    }
  }

  std::vector<VertexName> vertex_names(const Json& root, const char* key, const char* one) const {
    std::vector<VertexName> names;
    if (!root.contains(key)) return names;
    if (!root[key].is_array()) fail("\"" + std::string(key) + "\" must be a list");
    for (const Json& named : root[key]) {
      const std::string where = one + (" " + std::to_string(names.size() + 1));
      if (!named.is_object() || !named.contains("name") || !named["name"].is_string() ||
          !named.contains("vertex"))
        fail(where + " needs a \"name\" and a \"vertex\"");
      require_keys(named, {"name", "vertex"}, where);
      names.push_back({named["name"].get<std::string>(), vertex(named["vertex"], where)});
    }
    return names;
  }

  std::string path_;
  const TriangleMesh& mesh_;
  std::optional<SurfaceGraph> graph_;
  SeamFile file_;
};

}  // namespace

std::vector<std::array<int, 2>> SeamFile::edges() const {
  std::vector<std::array<int, 2>> all;
  for (const SeamCut& cut : cuts) all.insert(all.end(), cut.edges.begin(), cut.edges.end());
  return all;
}

SeamFile read_seam_file(const std::filesystem::path& path, const TriangleMesh& mesh) {
  return parse_seams(read_text_file(path), path, mesh);
}

SeamFile parse_seams(const std::string& text, const std::filesystem::path& path, const TriangleMesh& mesh) {
  try {
    return SeamReader(path.string(), mesh).run(Json::parse(text));
  } catch (const Json::exception& error) {
    throw FormatError(path.string() + ": not valid JSON: " + json_reason(error.what()));
  }
}

}  // namespace bespoke
