#include "bespoke/catalog/map_difference.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "bespoke/bake/error_points.h"
#include "bespoke/mapping/affine_map.h"

namespace bespoke {
namespace {

// Of each map. What none of n points exceeds, less than 3/n of the band does, at 95 % confidence.
constexpr std::size_t points_of_a_map = 150'000;
constexpr std::uint64_t points_seed = 12;

// Enough points for a call to keep all threads busy.
constexpr Eigen::Index points_per_call = 1 << 16;

/// E and Γ, through the values as they are stored.
struct ComparedMap {
  ElasticChain elastic;
  RigidTransform target_from_source;

  AffineMap affine() const { return compose(as_affine(target_from_source), elastic.affine()); }
};

ComparedMap compared(const Asset& asset) { return {baked_chain(asset.steps), asset.target_from_source}; }

void append(Points& points, const Points& more) {
  points.conservativeResize(3, points.cols() + more.cols());
  points.rightCols(more.cols()) = more;
}

void append_band(const Asset& asset, std::size_t count, Points& points) {
  AffineMap before;  // the affine parts of the steps before
  for (const MapStep& step : asset.steps) {
    const AffineMap back = inverse(before);
    const std::size_t share =
        count / (asset.steps.size() * std::max<std::size_t>(1, step.pyramid.levels.size()));
    for (std::size_t level = 0; level < step.pyramid.levels.size(); ++level)
      append(points, back * random_points(step.pyramid.lattice(static_cast<int>(level)),
                                          step.pyramid.levels[level].leaves, share, points_seed + level));
    before = compose(step.affine, before);
  }
}

PointDifference difference_at(const ComparedMap& a, const ComparedMap& b, const Points& x,
                              const Progress& progress) {
  PointDifference found;
  std::vector<double> distances, elastic;
  double largest = -1;  // so that the first point counts, also at distance 0
  for (Eigen::Index first = 0; first < x.cols(); first += points_per_call) {
    progress.step("compare", static_cast<std::size_t>(first), static_cast<std::size_t>(x.cols()));
    const Points part = x.middleCols(first, std::min(points_per_call, x.cols() - first));
    const Points elastic_a = a.elastic(part), elastic_b = b.elastic(part);
    const Points image_a = a.target_from_source * elastic_a, image_b = b.target_from_source * elastic_b;
    for (Eigen::Index i = 0; i < part.cols(); ++i) {
      elastic.push_back((elastic_a.col(i) - elastic_b.col(i)).norm());
      distances.push_back((image_a.col(i) - image_b.col(i)).norm());
      if (distances.back() <= largest) continue;
      largest = distances.back();
      found.largest = part.col(i);
      found.image_a = image_a.col(i);
      found.image_b = image_b.col(i);
    }
  }
  found.distance = summarize(std::move(distances));
  found.elastic = summarize(std::move(elastic));
  return found;
}

Points corners_of(const Box& box) {
  Points corners(3, 8);
  for (int i = 0; i < 8; ++i)
    corners.col(i) = box.corner(static_cast<Box::CornerType>(i));  // bit k: the larger coordinate k
  return corners;
}

}  // namespace

Points points_of_bands(const Asset& a, const Asset& b, std::size_t count) {
  Points points(3, 0);
  append_band(a, count, points);
  append_band(b, count, points);
  return points;
}

MapDifference map_difference(const Asset& a, const Asset& b, const std::vector<Points>& products,
                             const Progress& progress) {
  const ComparedMap map_a = compared(a), map_b = compared(b);
  const Points corners = corners_of(a.record.source.box.merged(b.record.source.box));
  const Points band = points_of_bands(a, b, points_of_a_map);
  MapDifference difference;
  difference.band = difference_at(map_a, map_b, band.cols() > 0 ? band : corners, progress);
  for (const Points& product : products)
    difference.products.push_back(difference_at(map_a, map_b, product, progress));
  // The distance of two affine maps is convex, so that it is largest at a corner.
  difference.affine = (map_a.affine() * corners - map_b.affine() * corners).colwise().norm().maxCoeff();
  return difference;
}

}  // namespace bespoke
