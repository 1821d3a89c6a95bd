#include "bespoke/pattern/seam_file.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "bespoke/error.h"
#include "bespoke/mesh/surface_paths.h"

namespace bespoke {
namespace {

using Json = nlohmann::json;

class SeamReader {
 public:
  SeamReader(std::string path, const TriangleMesh& mesh) : path_(std::move(path)), mesh_(mesh) {}

  SeamFile run(const Json& root) {
    if (!root.is_object()) fail("it must hold one object with \"seams\"");
    require_keys(root, {"seams", "pieces"}, "the file");
    if (!root.contains("seams") || !root["seams"].is_array()) fail("\"seams\" must be a list");
    for (const Json& seam : root["seams"]) add_seam(seam);
    if (root.contains("pieces")) {
      if (!root["pieces"].is_array()) fail("\"pieces\" must be a list");
      for (const Json& piece : root["pieces"]) add_name(piece);
    }
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
    const std::string where = "seam " + std::to_string(++seams_);
    if (!seam.is_object()) fail(where + " must be an object with \"edges\" or \"path\"");
    require_keys(seam, {"edges", "path", "name"}, where);
    if (seam.contains("edges") == seam.contains("path")) fail(where + " needs either \"edges\" or \"path\"");
    const Json& list = seam.contains("edges") ? seam["edges"] : seam["path"];
    if (!list.is_array() || list.empty()) fail(where + " must be a list that is not empty");
    if (seam.contains("edges")) {
      for (const Json& edge : list) {
        if (!edge.is_array() || edge.size() != 2) fail(where + ": an edge is a pair of vertices");
        file_.edges.push_back({vertex(edge[0], where), vertex(edge[1], where)});
      }
      return;
    }
    if (list.size() < 2) fail(where + ": a path has two vertices or more");
    for (std::size_t k = 0; k + 1 < list.size(); ++k)
      add_way(vertex(list[k], where), vertex(list[k + 1], where), where);
  }

  /// From the end back along edges that the distance grows by exactly.
  void add_way(int from, int to, const std::string& where) {
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
      file_.edges.push_back({before, at});
      at = before;
    }
  }

  void add_name(const Json& piece) {
    const std::string where = "piece " + std::to_string(file_.names.size() + 1);
    if (!piece.is_object() || !piece.contains("name") || !piece["name"].is_string() ||
        !piece.contains("vertex"))
      fail(where + " needs a \"name\" and a \"vertex\"");
    require_keys(piece, {"name", "vertex"}, where);
    file_.names.push_back({piece["name"].get<std::string>(), vertex(piece["vertex"], where)});
  }

  std::string path_;
  const TriangleMesh& mesh_;
  std::optional<SurfaceGraph> graph_;
  SeamFile file_;
  int seams_ = 0;
};

}  // namespace

SeamFile read_seam_file(const std::filesystem::path& path, const TriangleMesh& mesh) {
  std::ifstream in(path);
  if (!in) throw FileError(path.string() + ": cannot be opened");
  try {
    return SeamReader(path.string(), mesh).run(Json::parse(in));
  } catch (const Json::exception& error) {
    throw FormatError(path.string() + ": " + error.what());
  }
}

}  // namespace bespoke
