#include "bespoke/alignment/geodesic_counterparts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/median.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/spread_points.h"
#include "bespoke/mesh/surface_paths.h"
#include "bespoke/parallel.h"
#include "bespoke/topology/edge_refinement.h"

namespace bespoke {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// Longer edges than the spacing of so many vertices are halved, 2 % of a body's height: counterparts are
/// vertices.
constexpr double vertices_per_area = 4000;

/// A surface, and distances along it from some of its points to all of its vertices.
class MeasuredSurface {
 public:
  explicit MeasuredSurface(const TriangleMesh& mesh)
      : mesh_(refine_long_edges(mesh, std::sqrt(vertex_areas(mesh).sum() / vertices_per_area)).mesh),
        graph_(edge_and_crossing_graph(mesh_)) {}

  std::vector<SurfacePoint> feet(const Points& points) const {
    const ClosestPointTree tree(mesh_);
    std::vector<SurfacePoint> all;
    for (const auto& point : points.colwise()) all.push_back(*tree.closest(point));
    return all;
  }

  /// n: of every vertex from the nearest of the points.
  Eigen::VectorXd distances(const std::vector<SurfacePoint>& points) const {
    std::vector<PathStart> starts;
    for (const SurfacePoint& point : points)
      for (const PathStart& corner : path_starts(mesh_, point)) starts.push_back(corner);
    return path_lengths(graph_, starts);
  }

  void measure_from(const std::vector<SurfacePoint>& points) {
    feet_ = points;
    from_.resize(points.size());
    parallel_for(from_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) from_[k] = distances({points[k]});
    });
  }
  void measure_from(int vertex) { from_.push_back(distances(vertex)); }
  void measure_from(int vertex, std::size_t instead_of) { from_[instead_of] = distances(vertex); }

  Eigen::Index vertices() const { return mesh_.vertices.cols(); }
  Vector3 place(int vertex) const { return mesh_.vertices.col(vertex); }
  double diagonal() const { return bespoke::diagonal(mesh_.vertices); }
  /// n: of every vertex from one of the points measured from.
  const Eigen::VectorXd& from(std::size_t point) const { return from_[point]; }
  /// Between two of the points, not vertices, measured from.
  double between(std::size_t i, std::size_t j) const {
    return length_to(from_[i], path_starts(mesh_, feet_[j]));
  }

 private:
  Eigen::VectorXd distances(int vertex) const {
    const PathStart start{vertex};
    return path_lengths(graph_, {&start, 1});
  }

  TriangleMesh mesh_;
  SurfaceGraph graph_;
  std::vector<SurfacePoint> feet_;
  std::vector<Eigen::VectorXd> from_;
};

/// The vertex farthest from what `distances` are from, and how far it is; infinite ones do not count.
std::pair<int, double> farthest(const Eigen::VectorXd& distances) {
  std::pair<int, double> found{0, 0};
  for (Eigen::Index i = 0; i < distances.size(); ++i)
    if (std::isfinite(distances[i]) && distances[i] > found.second)
      found = {static_cast<int>(i), distances[i]};
  return found;
}

/// The places of the source so far, each with its counterpart and behind the pairs.
class CounterpartSearch {
 public:
  CounterpartSearch(MeasuredSurface source, MeasuredSurface target, std::size_t pairs,
                    const CounterpartOptions& options)
      : source_(std::move(source)), target_(std::move(target)), pairs_(pairs), options_(options) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < pairs_; ++i) {
      const auto [vertex, reach] = farthest(source_.from(i));
      largest_ = std::max(largest_, reach);
      for (std::size_t j = i + 1; j < pairs_; ++j) {
        const double ratio = target_.between(i, j) / source_.between(i, j);
        if (std::isfinite(ratio) && ratio > 0) ratios.push_back(ratio);
      }
    }
    if (!ratios.empty()) ratio_ = median(std::move(ratios));
  }

  /// Returns n: how far every vertex of the source is from the place.
  const Eigen::VectorXd& add(int source_vertex) {
    Found found{source_vertex};
    look_for(found, places_.size());
    source_.measure_from(found.source);
    target_.measure_from(found.target);
    places_.push_back(found);
    return source_.from(pairs_ + places_.size() - 1);
  }

  int size() const { return static_cast<int>(places_.size()); }
  Vector3 place(int source_vertex) const { return source_.place(source_vertex); }

  /// Looks for every counterpart again, by all the others.
  void sweep() {
    for (std::size_t k = 0; k < places_.size(); ++k) {
      const int before = places_[k].target;
      look_for(places_[k], k);
      if (places_[k].target != before) target_.measure_from(places_[k].target, pairs_ + k);
    }
  }

  GeodesicCounterparts credible() const {
    GeodesicCounterparts result{Points(3, 0), Points(3, 0)};
    for (const Found& found : places_) {
      if (!(found.misfit <= options_.max_misfit)) continue;
      for (Points* points : {&result.sources, &result.targets})
        points->conservativeResize(3, points->cols() + 1);
      result.sources.rightCols(1) = source_.place(found.source);
      result.targets.rightCols(1) = target_.place(found.target);
    }
    return result;
  }

 private:
  struct Found {
    int source = 0, target = 0;  // vertices
    double misfit = infinity;
  };

  /// The counterpart of the place by all pairs and places but number `self` of these.
  void look_for(Found& place, std::size_t self) const {
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(target_.vertices());
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(target_.vertices());
    double nearest = infinity, all_weights = 0;
    for (std::size_t i = 0; i < pairs_ + places_.size(); ++i) {
      const double along_source = ratio_ * source_.from(i)[place.source];
      if (i == pairs_ + self || !std::isfinite(along_source)) continue;
      const double weight = std::pow(along_source + options_.softening * ratio_ * largest_, -2);
      for (Eigen::Index q = 0; q < squares.size(); ++q) {
        const double there = target_.from(i)[q];
        if (!std::isfinite(there)) continue;
        squares[q] += weight * (there - along_source) * (there - along_source);
        weights[q] += weight;
      }
      nearest = std::min(nearest, along_source);
      all_weights += weight;
    }
    // Another component than most of the pairs' says nothing.
    double least = infinity;
    for (Eigen::Index q = 0; q < squares.size(); ++q) {
      if (!(weights[q] > all_weights / 2) || !(squares[q] / weights[q] < least)) continue;
      least = squares[q] / weights[q];
      place.target = static_cast<int>(q);
    }
    place.misfit = std::sqrt(least) / nearest;
  }

  MeasuredSurface source_, target_;
  std::size_t pairs_;
  CounterpartOptions options_;
  double ratio_ = 1;    // of distances along the target to those along the source
  double largest_ = 0;  // along the source, mesh units
  std::vector<Found> places_;
};

}  // namespace

GeodesicCounterparts geodesic_counterparts(const TriangleMesh& source, const TriangleMesh& target,
                                           const CounterpartPairs& given, const CounterpartOptions& options,
                                           const Progress& progress) {
  const auto& [sources, targets] = given;
  if (sources.cols() != targets.cols())
    throw InvalidInput(std::to_string(sources.cols()) + " points of the source and " +
                       std::to_string(targets.cols()) + " of the target are no pairs");
  if (sources.cols() == 0) return {Points(3, 0), Points(3, 0)};
  MeasuredSurface from_source(source);
  const double unit = from_source.diagonal();
  const std::vector<SurfacePoint> feet = from_source.feet(sources);
  Eigen::VectorXd nearest = from_source.distances(feet);
  if (farthest(nearest).second < options.remote * unit) return {Points(3, 0), Points(3, 0)};

  const std::vector<int> pairs = spread_points(sources, options.max_pairs);
  std::vector<SurfacePoint> spread_feet;
  for (const int pair : pairs) spread_feet.push_back(feet[static_cast<std::size_t>(pair)]);
  MeasuredSurface from_target(target);
  from_source.measure_from(spread_feet);
  from_target.measure_from(from_target.feet(targets(Eigen::all, pairs)));
  CounterpartSearch search(std::move(from_source), std::move(from_target), pairs.size(), options);
  Points taken = sources;
  while (search.size() < options.max_count) {
    progress.check();
    const auto [place, distance] = farthest(nearest);
    if (distance < options.spacing * unit) break;
    const Vector3 x = search.place(place);
    if ((taken.colwise() - x).colwise().norm().minCoeff() < options.touching * unit) {
      nearest[place] = 0;
      continue;
    }
    nearest = nearest.cwiseMin(search.add(place));
    taken.conservativeResize(3, taken.cols() + 1);
    taken.rightCols(1) = x;
  }
  for (int k = 0; k < options.sweeps; ++k) {
    progress.check();
    search.sweep();
  }
  return search.credible();
}

}  // namespace bespoke
