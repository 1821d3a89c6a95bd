#include "seam_lines.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "bespoke/mesh/mesh_edges.h"

namespace bespoke {
namespace {

// Of an edge: a line that passes a vertex nearer than this goes through it, so that no faces become slivers.
constexpr double near_vertex = 0.08;

/// Points of lines and the segments between them.
class LevelLines {
 public:
  LevelLines(const TriangleMesh& mesh, const SeamLevel& seam)
      : mesh_(mesh), edges_(mesh_edges(mesh)), values_(mesh.vertices.cols()) {
    for (Eigen::Index v = 0; v < values_.size(); ++v) values_[v] = seam.level(mesh.vertices.col(v));
    put_vertices_on();
    for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) add_segment(f, seam.within);
  }

  std::vector<std::vector<EdgePoint>> run() {
    std::vector<std::vector<EdgePoint>> lines;
    for (const bool wants_ends : {true, false})  // open lines first, then the closed ones that are left
      for (const auto& [point, neighbours] : neighbours_)
        if (!wants_ends || neighbours.size() == 1)
          while (const auto next = unused(point)) lines.push_back(line_from(point, *next));
    return lines;
  }

 private:
  using Point = std::pair<int, int>;  // the edge's vertices, or twice the vertex

  /// Vertices near the line, but no two neighbours: an edge along it would be both sides' or none's.
  void put_vertices_on() {
    std::vector<char> is_on(static_cast<std::size_t>(values_.size()), 0);
    const VertexAdjacency adjacency = vertex_adjacency(mesh_);
    for (Eigen::Index v = 0; v < values_.size(); ++v) {
      const auto at = static_cast<std::size_t>(v);
      bool is_near = values_[v] == 0, is_alone = true;
      for (int k = adjacency.start[at]; k < adjacency.start[at + 1]; ++k) {
        const int other = adjacency.neighbours[static_cast<std::size_t>(k)];
        is_alone = is_alone && is_on[static_cast<std::size_t>(other)] == 0;
        is_near = is_near || (values_[v] * values_[other] < 0 &&
                              std::abs(values_[v]) < near_vertex * std::abs(values_[v] - values_[other]));
      }
      is_on[at] = is_near && is_alone;
    }
    for (Eigen::Index v = 0; v < values_.size(); ++v)
      if (is_on[static_cast<std::size_t>(v)] != 0)
        values_[v] = 0;
      else if (values_[v] == 0)
        values_[v] = 1e-9;  // cm: one of two neighbours on the line counts as beside it
  }

  Vector3 place(const Point& point) const {
    if (point.first == point.second) return mesh_.vertices.col(point.first);
    const double share = share_of(point);
    return (1 - share) * mesh_.vertices.col(point.first) + share * mesh_.vertices.col(point.second);
  }

  double share_of(const Point& point) const {
    const double a = values_[point.first], b = values_[point.second];
    return a / (a - b);
  }

  void add_segment(Eigen::Index face, const Field& within) {
    std::vector<Point> ends;
    for (int k = 0; k < 3; ++k) {
      const int a = mesh_.faces(k, face), b = mesh_.faces((k + 1) % 3, face);
      if (values_[a] == 0) ends.emplace_back(a, a);
      if (values_[a] * values_[b] < 0) ends.push_back(std::minmax({a, b}));
    }
    if (ends.size() != 2) return;
    // Where the other line crosses the same face, the flattening ends this one there.
    if (within && !(within(place(ends[0])) > 0) && !(within(place(ends[1])) > 0)) return;
    neighbours_[ends[0]].push_back(ends[1]);
    neighbours_[ends[1]].push_back(ends[0]);
  }

  std::optional<Point> unused(const Point& from) const {
    const std::vector<Point>& all = neighbours_.at(from);
    return all.empty() ? std::nullopt : std::optional(all.front());
  }

  void use(const Point& a, const Point& b) {
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
      std::vector<Point>& all = neighbours_[from];
      all.erase(std::find(all.begin(), all.end(), to));
    }
  }

  EdgePoint edge_point(const Point& point) const {
    if (point.first == point.second) return {point.first, point.first, 0};
    // A millionth of an edge is a hundredth of a micrometre.
    return {point.first, point.second, std::round(1e6 * share_of(point)) / 1e6};
  }

  std::vector<EdgePoint> line_from(Point at, Point next) {
    std::vector<EdgePoint> line{edge_point(at)};
    for (std::optional<Point> following = next; following; following = unused(at)) {
      use(at, *following);
      at = *following;
      line.push_back(edge_point(at));
    }
    return line;
  }

  const TriangleMesh& mesh_;
  MeshEdges edges_;
  Eigen::VectorXd values_;
  std::map<Point, std::vector<Point>> neighbours_;
};

int nearest_vertex(const TriangleMesh& mesh, const Vector3& x) {
  Eigen::Index nearest = 0;
  (mesh.vertices.colwise() - x).colwise().squaredNorm().minCoeff(&nearest);
  return static_cast<int>(nearest);
}

std::string list_text(const std::string& key, const std::vector<std::string>& rows) {
  std::string text = "\"" + key + "\": [";
  for (std::size_t k = 0; k < rows.size(); ++k) text += (k == 0 ? "\n  " : ",\n  ") + rows[k];
  return text + "]";
}

}  // namespace

std::vector<std::vector<EdgePoint>> level_lines(const TriangleMesh& mesh, const SeamLevel& seam) {
  return LevelLines(mesh, seam).run();
}

std::string seam_file_text(const TriangleMesh& mesh, const SeamPlan& plan) {
  using Json = nlohmann::ordered_json;
  std::vector<std::string> seams;
  for (const SeamLevel& level : plan.seams)
    for (const std::vector<EdgePoint>& line : level_lines(mesh, level)) {
      Json points = Json::array();
      for (const EdgePoint& point : line)
        points.push_back(point.a == point.b ? Json(point.a + 1)
                                            : Json{point.a + 1, point.b + 1, point.share});
      seams.push_back(Json{{"name", level.name}, {"line", points}}.dump());
    }
  const auto named = [&](const std::vector<SeamPoint>& points) {
    std::vector<std::string> rows;
    for (const SeamPoint& point : points)
      rows.push_back(Json{{"name", point.name}, {"vertex", nearest_vertex(mesh, point.near) + 1}}.dump());
    return rows;
  };
  return "{" + list_text("seams", seams) + ",\n" + list_text("pieces", named(plan.pieces)) + ",\n" +
         list_text("widths", named(plan.widths)) + "}\n";
}

}  // namespace bespoke
