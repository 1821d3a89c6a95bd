#include "bespoke/surface_fit/detail/unmatched_cavities.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/mesh/spread_points.h"
#include "bespoke/principal_widths.h"
#include "bespoke/rbf/global_rbf.h"

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

/// Places of the open surface around a cavity. `lined`: the vertices in cavities.
std::vector<int> open_places(const Points& vertices, const Cavity& cavity, const std::vector<char>& lined,
                             const UnmatchedCavitySettings& settings) {
  const Surroundings own(vertices(Eigen::all, cavity.vertices));
  std::vector<int> around;
  for (int i = 0; i < vertices.cols(); ++i)
    if (!lined[static_cast<std::size_t>(i)] &&
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

/// Harmonic extension of the offsets at the cavity's boundary into it, by inverse edge length. `offsets`:
/// 3×n, of the boundary's vertices; the cavity's are set.
void spread_from_rim(const Cavity& cavity, const Points& vertices, Points& offsets) {
  std::map<int, Eigen::Index> column;
  for (const int vertex : cavity.vertices) column.emplace(vertex, static_cast<Eigen::Index>(column.size()));
  const auto size = static_cast<Eigen::Index>(column.size());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(size, 3);
  double largest = 0;
  for (const MeshEdge& edge : cavity.edges) {
    const double length = (vertices.col(edge.a) - vertices.col(edge.b)).norm();
    if (!(length > 0)) continue;
    largest = std::max(largest, 1 / length);
    for (const auto& [from, to] : {std::pair(edge.a, edge.b), std::pair(edge.b, edge.a)}) {
      const auto own = column.find(from), other = column.find(to);
      if (own == column.end()) continue;
      entries.emplace_back(own->second, own->second, 1 / length);
      if (other != column.end())
        entries.emplace_back(own->second, other->second, -1 / length);
      else
        right.row(own->second) += offsets.col(to).transpose() / length;
    }
  }
  constexpr double free_floating = 1e-9;  // of the largest weight: a cavity without boundary stays
  for (Eigen::Index i = 0; i < size; ++i) entries.emplace_back(i, i, free_floating * largest);
  Eigen::SparseMatrix<double> matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  if (solver.info() != Eigen::Success)
    throw SolverError("surface fitting: the system of a cavity is singular");
  const Eigen::MatrixX3d solution = solver.solve(right);
  for (const auto& [vertex, row] : column) offsets.col(vertex) = solution.row(row).transpose();
}

}  // namespace

std::vector<Cavity> unmatched_cavities(const std::vector<Cavity>& cavities, const TriangleMesh& source,
                                       const TriangleMesh& target, const std::vector<char>& lined,
                                       const UnmatchedCavitySettings& settings) {
  const Eigen::VectorXd areas = vertex_areas(source), target_areas = vertex_areas(target);
  std::vector<Cavity> lacking;
  for (const Cavity& cavity : cavities) {
    const Surroundings own(source.vertices(Eigen::all, cavity.vertices));
    double met = 0;
    for (Eigen::Index i = 0; i < target.vertices.cols(); ++i)
      if (lined[static_cast<std::size_t>(i)] && (target.vertices.col(i) - own.center).norm() <= own.radius)
        met += target_areas[i];
    if (met < settings.min_matched * areas(cavity.vertices).sum()) lacking.push_back(cavity);
  }
  return lacking;
}

Points carried_by_space(const RegisteredSurface& laid, const std::vector<Cavity>& cavities,
                        const std::vector<char>& lined, const UnmatchedCavitySettings& settings) {
  Points vertices = laid.fitted;
  const Points& source = laid.source.vertices;
  for (const Cavity& cavity : cavities) {
    const std::vector<int> places = open_places(source, cavity, lined, settings);
    if (!span_space(source(Eigen::all, places), settings.min_width)) continue;
    const auto count = static_cast<Eigen::Index>(places.size());
    const GlobalRbf warp(source(Eigen::all, places), laid.fitted(Eigen::all, places),
                         Eigen::VectorXd::Constant(count, settings.weight));
    std::vector<int> rim;
    for (const MeshEdge& edge : cavity.edges)
      for (const int vertex : {edge.a, edge.b})
        if (!lined[static_cast<std::size_t>(vertex)]) rim.push_back(vertex);
    Points offsets = Points::Zero(3, source.cols());
    if (!rim.empty()) offsets(Eigen::all, rim) = laid.fitted(Eigen::all, rim) - warp(source(Eigen::all, rim));
    spread_from_rim(cavity, source, offsets);
    vertices(Eigen::all, cavity.vertices) =
        warp(source(Eigen::all, cavity.vertices)) + offsets(Eigen::all, cavity.vertices);
  }
  return vertices;
}

}  // namespace bespoke
