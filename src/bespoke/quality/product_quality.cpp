#include "bespoke/quality/product_quality.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "bespoke/error.h"
#include "bespoke/quality/detail/surface_samples.h"
#include "bespoke/quality/self_intersection.h"

namespace bespoke {
namespace {

struct Clearances {
  SignedDistance::Values vertices;
  SignedDistance::Values samples;
};

/// What counts as inside, mesh units.
struct InsideTolerances {
  double source = 0, target = 0;
};

Penetration penetration(const Clearances& clearances, double tolerance) {
  const auto count_inside = [&](const SignedDistance::Values& values) {
    std::size_t inside = 0;
    for (std::size_t i = 0; i < values.distance.size(); ++i) inside += values.distance[i] < -tolerance;
    return inside;
  };
  Penetration result;
  result.vertices = count_inside(clearances.vertices);
  if (!clearances.samples.distance.empty())
    result.area_share = static_cast<double>(count_inside(clearances.samples)) /
                        static_cast<double>(clearances.samples.distance.size());
  for (const SignedDistance::Values* values : {&clearances.vertices, &clearances.samples})
    for (const double distance : values->distance) result.deepest = std::max(result.deepest, -distance);
  return result;
}

/// The same places before and after.
Sinking sinking(const SignedDistance::Values& before, const SignedDistance::Values& after,
                const InsideTolerances& tolerances) {
  Sinking result;
  std::size_t count = 0;
  for (std::size_t i = 0; i < after.distance.size(); ++i) {
    if (before.distance[i] < -tolerances.source || !(after.distance[i] < -tolerances.target)) continue;
    ++count;
    result.deepest = std::max(result.deepest, -after.distance[i]);
  }
  if (count > 0) result.share = double(count) / double(after.distance.size());
  return result;
}

void compare_clearances(const SignedDistance::Values& before, const SignedDistance::Values& after,
                        ProductQuality& quality) {
  std::vector<double> at_source, at_target, change;
  for (std::size_t i = 0; i < before.distance.size(); ++i) {
    if (!before.sided[i] || !after.sided[i]) {
      ++quality.unsided_vertices;
      continue;
    }
    at_source.push_back(before.distance[i]);
    at_target.push_back(after.distance[i]);
    change.push_back(std::abs(after.distance[i] - before.distance[i]));
  }
  quality.clearance_before = spread(std::move(at_source));
  quality.clearance_after = spread(std::move(at_target));
  quality.clearance_change = summarize(std::move(change));
}

}  // namespace

ProductQuality product_quality(const TriangleMesh& before, const Points& after, const Bodies& bodies,
                               const ProductQualityOptions& options) {
  if (after.cols() != before.vertices.cols())
    throw InvalidInput("product_quality got " + std::to_string(after.cols()) + " vertices after and " +
                       std::to_string(before.vertices.cols()) + " before");
  if (!before.vertices.allFinite() || !after.allFinite())
    throw InvalidInput("a vertex of the product is not finite");
  const TriangleMesh moved{after, before.faces};
  ProductQuality quality;
  quality.vertices = static_cast<std::size_t>(after.cols());
  quality.faces = static_cast<std::size_t>(before.faces.cols());
  SurfaceSamples samples;
  if (before.faces.cols() > 0) {
    samples = sample_surface(before, options.samples);
    quality.distortion = mesh_distortion(before, after);
    quality.self_intersections_before = self_intersections(before).size();
    quality.self_intersections_after = self_intersections(moved).size();
  }
  // The same points of the product before and after.
  const Clearances at_source{bodies.from_source(before.vertices),
                             bodies.from_source(positions(samples, before))};
  const Clearances at_target{bodies.from_target(after), bodies.from_target(positions(samples, moved))};
  compare_clearances(at_source.vertices, at_target.vertices, quality);
  const InsideTolerances tolerances{options.inside_tolerance * diagonal(bodies.source.vertices),
                                    options.inside_tolerance * diagonal(bodies.target.vertices)};
  quality.penetration_before = penetration(at_source, tolerances.source);
  quality.penetration_after = penetration(at_target, tolerances.target);
  quality.sinking = samples.faces.empty() ? sinking(at_source.vertices, at_target.vertices, tolerances)
                                          : sinking(at_source.samples, at_target.samples, tolerances);
  return quality;
}

std::string to_string(const Sinking& sinking) {
  char text[200];
  std::snprintf(text, sizeof text,
                "%.1f %% of it lies inside the target, though not inside the source before, at most %.4g "
                "deep",
                100 * sinking.share, sinking.deepest);
  return text;
}

}  // namespace bespoke
