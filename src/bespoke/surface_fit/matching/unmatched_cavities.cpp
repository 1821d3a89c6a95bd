#include "bespoke/surface_fit/matching/unmatched_cavities.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bespoke/mesh/spread_points.h"
#include "bespoke/principal_widths.h"
#include "bespoke/rbf/global_rbf.h"
#include "bespoke/surface_fit/matching/harmonic_extension.h"

namespace bespoke {
namespace {

/// A ball about some of the points, mesh units.
struct Surroundings {
  Vector3 center;
  double radius;

  explicit Surroundings(const Points& points)
      : center(points.rowwise().mean()),
        radius(std::sqrt((points.colwise() - center).colwise().squaredNorm().maxCoeff())) {}
};

constexpr double min_apart = 1e-6;  // of a cavity's radius: nearer places are one

/// Places of the open surface around a cavity. `in_cavity`: the vertices in cavities.
std::vector<int> open_places(const Points& vertices, const Cavity& cavity, const std::vector<char>& in_cavity,
                             const UnmatchedCavitySettings& settings) {
  const Surroundings own(vertices(Eigen::all, cavity.vertices));
  std::vector<int> around;
  for (int i = 0; i < vertices.cols(); ++i)
    if (!in_cavity[static_cast<std::size_t>(i)] &&
        (vertices.col(i) - own.center).norm() <= settings.around * own.radius)
      around.push_back(i);
  std::vector<int> chosen;
  for (const int column : spread_points(vertices(Eigen::all, around), settings.places)) {
    const int vertex = around[static_cast<std::size_t>(column)];
    // The next are no farther from those before.
    if (std::any_of(chosen.begin(), chosen.end(), [&](int other) {
          return (vertices.col(vertex) - vertices.col(other)).norm() < min_apart * own.radius;
        }))
      break;
    chosen.push_back(vertex);
  }
  return chosen;
}

bool span_space(const Points& points, double min_width) {
  if (points.cols() < 4) return false;
  const Vector3 widths = principal_widths(points).widths;
  return widths[2] > min_width * widths[0];
}

}  // namespace

std::vector<Cavity> unmatched_cavities(const std::vector<Cavity>& cavities, const TriangleMesh& source,
                                       const TriangleMesh& target, const std::vector<char>& in_cavity,
                                       const UnmatchedCavitySettings& settings) {
  const Eigen::VectorXd areas = vertex_areas(source), target_areas = vertex_areas(target);
  std::vector<Cavity> unmatched;
  for (const Cavity& cavity : cavities) {
    const Surroundings own(source.vertices(Eigen::all, cavity.vertices));
    double matched = 0;
    for (Eigen::Index i = 0; i < target.vertices.cols(); ++i)
      if (in_cavity[static_cast<std::size_t>(i)] &&
          (target.vertices.col(i) - own.center).norm() <= own.radius)
        matched += target_areas[i];
    if (matched < settings.min_matched * areas(cavity.vertices).sum()) unmatched.push_back(cavity);
  }
  return unmatched;
}

Points carried_by_space(const RegisteredSurface& registered, const std::vector<Cavity>& cavities,
                        const std::vector<char>& in_cavity, const UnmatchedCavitySettings& settings) {
  Points vertices = registered.fitted;
  const Points& source = registered.source.vertices;
  if (cavities.empty()) return vertices;
  const VertexAdjacency adjacency = vertex_adjacency(registered.source);
  for (const Cavity& cavity : cavities) {
    const std::vector<int> places = open_places(source, cavity, in_cavity, settings);
    if (!span_space(source(Eigen::all, places), settings.min_width)) continue;
    const auto count = static_cast<Eigen::Index>(places.size());
    const GlobalRbf warp(source(Eigen::all, places), registered.fitted(Eigen::all, places),
                         Eigen::VectorXd::Constant(count, settings.weight));
    std::vector<int> rim;
    for (const MeshEdge& edge : cavity.edges)
      for (const int vertex : {edge.a, edge.b})
        if (!in_cavity[static_cast<std::size_t>(vertex)]) rim.push_back(vertex);
    Points offsets = Points::Zero(3, source.cols());
    if (!rim.empty())
      offsets(Eigen::all, rim) = registered.fitted(Eigen::all, rim) - warp(source(Eigen::all, rim));
    offsets = extend_harmonically(source, adjacency, cavity.vertices, std::move(offsets));
    vertices(Eigen::all, cavity.vertices) =
        warp(source(Eigen::all, cavity.vertices)) + offsets(Eigen::all, cavity.vertices);
  }
  return vertices;
}

}  // namespace bespoke
