// The grid of points beside nanoflann's k-d tree: built, and asked for the neighbours of every point within a
// radius that holds about forty, as bases of RBFs and nodes of deformation graphs do.
//   point_grid_benchmark --benchmark_time_unit=ms
#include <benchmark/benchmark.h>

#include <nanoflann.hpp>

#include "bespoke/rbf/point_grid.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

const Points& sphere_points() {
  static const Points points = shapes::icosphere(6).vertices;
  return points;
}

// 40,962 points on 4 π: a disk of this radius holds forty.
constexpr double query_radius = 0.0625;

struct PointCloud {
  const Points& points;
  std::size_t kdtree_get_point_count() const { return static_cast<std::size_t>(points.cols()); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(i));
  }
  template <class Bounds>
  bool kdtree_get_bbox(Bounds&) const {
    return false;
  }
};
using KdTree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, PointCloud>, PointCloud, 3>;

/// What nanoflann calls for every point within the radius, without a list.
struct Visitor {
  double squared_radius, sum = 0;
  std::size_t count = 0;
  bool full() const { return true; }
  bool empty() const { return count == 0; }
  std::size_t size() const { return count; }
  bool addPoint(double squared_distance, std::size_t) {
    if (squared_distance < squared_radius) {
      sum += squared_distance;
      ++count;
    }
    return true;
  }
  double worstDist() const { return squared_radius; }
};

void GridBuild(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(PointGrid(sphere_points(), query_radius));
}
BENCHMARK(GridBuild);

void TreeBuild(benchmark::State& state) {
  const PointCloud cloud{sphere_points()};
  for (auto _ : state) benchmark::DoNotOptimize(KdTree(3, cloud));
}
BENCHMARK(TreeBuild);

void GridVisits(benchmark::State& state) {
  const PointGrid grid(sphere_points(), query_radius);
  double sum = 0;
  for (auto _ : state) {
    for (const auto& x : sphere_points().colwise())
      grid.for_each_within(x, query_radius, [&](int, double squared_distance) { sum += squared_distance; });
    benchmark::DoNotOptimize(sum);
  }
}
BENCHMARK(GridVisits);

void TreeVisits(benchmark::State& state) {
  const PointCloud cloud{sphere_points()};
  const KdTree tree(3, cloud);
  double sum = 0;
  for (auto _ : state) {
    for (const auto& x : sphere_points().colwise()) {
      Visitor visitor{query_radius * query_radius};
      tree.findNeighbors(visitor, x.data(), nanoflann::SearchParams());
      sum += visitor.sum;
    }
    benchmark::DoNotOptimize(sum);
  }
}
BENCHMARK(TreeVisits);

}  // namespace
}  // namespace bespoke
