#include "bespoke/quality/plane_section.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "bespoke/error.h"

namespace bespoke {
namespace {

using Edge = std::pair<int, int>;

/// Where the plane crosses edges, and which crossings are joined across a face.
struct Crossings {
  std::map<Edge, Vector3> at;
  std::map<Edge, std::vector<Edge>> next;
};

Crossings crossings_of(const TriangleMesh& mesh, const Plane& plane) {
  const Eigen::VectorXd height =
      ((mesh.vertices.colwise() - plane.point).transpose() * plane.normal.normalized()).eval();
  Crossings found;
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    std::vector<Edge> crossed;
    for (int side = 0; side < 3; ++side) {
      const Edge edge = std::minmax({mesh.faces(side, face), mesh.faces((side + 1) % 3, face)});
      const double from = height[edge.first], to = height[edge.second];
      // A vertex in the plane counts as above it, so that every line passes beside it.
      if ((from < 0) == (to < 0)) continue;
      found.at[edge] = mesh.vertices.col(edge.first) +
                       from / (from - to) * (mesh.vertices.col(edge.second) - mesh.vertices.col(edge.first));
      crossed.push_back(edge);
    }
    if (crossed.size() != 2) continue;
    found.next[crossed[0]].push_back(crossed[1]);
    found.next[crossed[1]].push_back(crossed[0]);
  }
  return found;
}

/// The crossings from `start` on until no new one follows; empty unless that closes a line.
std::vector<Edge> walk(const Crossings& crossings, const Edge& start, std::set<Edge>& seen) {
  std::vector<Edge> way;
  for (Edge at = start;;) {
    way.push_back(at);
    seen.insert(at);
    const std::vector<Edge>& ways = crossings.next.at(at);
    const auto onward =
        std::find_if(ways.begin(), ways.end(), [&](const Edge& edge) { return !seen.contains(edge); });
    if (onward != ways.end()) {
      at = *onward;
      continue;
    }
    const bool closes = way.size() > 2 && std::find(ways.begin(), ways.end(), start) != ways.end();
    return closes ? way : std::vector<Edge>();
  }
}

}  // namespace

std::vector<Points> closed_sections(const TriangleMesh& mesh, const Plane& plane) {
  if (!(plane.point.allFinite() && plane.normal.allFinite() && plane.normal.norm() > 0))
    throw InvalidInput("a plane needs a finite point and a normal that is not zero");
  const Crossings crossings = crossings_of(mesh, plane);
  std::vector<Points> lines;
  std::set<Edge> seen;
  for (const auto& [start, ways] : crossings.next) {
    if (seen.contains(start)) continue;
    const std::vector<Edge> way = walk(crossings, start, seen);
    if (way.empty()) continue;
    Points& line = lines.emplace_back(3, static_cast<Eigen::Index>(way.size()));
    for (std::size_t i = 0; i < way.size(); ++i)
      line.col(static_cast<Eigen::Index>(i)) = crossings.at.at(way[i]);
  }
  std::stable_sort(lines.begin(), lines.end(), [](const Points& a, const Points& b) {
    return line_length(a, true) > line_length(b, true);
  });
  return lines;
}

double line_length(const Points& points, bool closed) {
  double length = 0;
  for (Eigen::Index i = 1; i < points.cols(); ++i) length += (points.col(i) - points.col(i - 1)).norm();
  if (closed && points.cols() > 1) length += (points.col(0) - points.col(points.cols() - 1)).norm();
  return length;
}

}  // namespace bespoke
