#include "bespoke/quality/plane_section.h"

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/mesh/equal_positions.h"

namespace bespoke {
namespace {

using Edge = std::pair<int, int>;

/// Where the plane crosses edges, and which crossings are joined across a face.
struct Crossings {
  std::map<Edge, Vector3> at;
  std::map<Edge, std::vector<Edge>> next;
};

/// The faces by the first vertex at each position: files split vertices along seams of texture and normals,
/// which must not open a section.
Faces joined_faces(const TriangleMesh& mesh) {
  const std::vector<int> first = first_at_equal_position(mesh.vertices);
  return mesh.faces.unaryExpr([&](int vertex) { return first[static_cast<std::size_t>(vertex)]; });
}

Crossings crossings_of(const TriangleMesh& mesh, const Plane& plane) {
  const Eigen::VectorXd height =
      (mesh.vertices.colwise() - plane.point).transpose() * plane.normal.normalized();
  const Faces faces = joined_faces(mesh);
  Crossings found;
  for (Eigen::Index face = 0; face < faces.cols(); ++face) {
    std::vector<Edge> crossed;
    for (int side = 0; side < 3; ++side) {
      const Edge edge = std::minmax({faces(side, face), faces((side + 1) % 3, face)});
      const double from = height[edge.first], to = height[edge.second];
      // A vertex in the plane counts as above it, so that every line passes beside it.
      if ((from < 0) == (to < 0)) continue;
      found.at[edge] = mesh.vertices.col(edge.first) +
                       from / (from - to) * (mesh.vertices.col(edge.second) - mesh.vertices.col(edge.first));
      crossed.push_back(edge);
    }
    // The same edge twice: a face that has become a line.
    if (crossed.size() != 2 || crossed[0] == crossed[1]) continue;
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

/// Whether a closed line in a plane goes round the plane's point: a ray from the point crosses it an odd
/// number of times.
bool goes_round(const Points& line, const Plane& plane) {
  const Vector3 along = plane.normal.unitOrthogonal();
  const Vector3 across = plane.normal.normalized().cross(along);
  bool inside = false;
  for (Eigen::Index i = 0; i < line.cols(); ++i) {
    const Vector3 from = line.col(i) - plane.point;
    const Vector3 to = line.col((i + 1) % line.cols()) - plane.point;
    const double from_height = from.dot(across), to_height = to.dot(across);
    if ((from_height < 0) == (to_height < 0)) continue;
    const double share = from_height / (from_height - to_height);
    if ((from + share * (to - from)).dot(along) > 0) inside = !inside;
  }
  return inside;
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

std::optional<Points> section_about_point(const TriangleMesh& mesh, const Plane& plane) {
  const std::vector<Points> lines = closed_sections(mesh, plane);
  std::optional<Points> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (const Points& line : lines) {
    if (goes_round(line, plane)) return line;
    const double distance = (line.colwise() - plane.point).colwise().norm().minCoeff();
    if (distance >= least) continue;
    least = distance;
    nearest = line;
  }
  return nearest;
}

double line_length(const Points& points, bool closed) {
  double length = 0;
  for (Eigen::Index i = 1; i < points.cols(); ++i) length += (points.col(i) - points.col(i - 1)).norm();
  if (closed && points.cols() > 1) length += (points.col(0) - points.col(points.cols() - 1)).norm();
  return length;
}

}  // namespace bespoke
