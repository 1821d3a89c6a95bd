#include "bespoke/quality/product_quality.h"

#include <algorithm>
#include <cmath>

#include "bespoke/error.h"
#include "bespoke/number_format.h"
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
NewPenetration new_penetration_of(const SignedDistance::Values& before, const SignedDistance::Values& after,
                                  const InsideTolerances& tolerances) {
  NewPenetration result;
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

void require_product(const TriangleMesh& before, const Points& after) {
  if (after.cols() != before.vertices.cols())
    throw InvalidInput("product_quality got " + std::to_string(after.cols()) + " vertices after and " +
                       std::to_string(before.vertices.cols()) + " before");
  if (!before.vertices.allFinite() || !after.allFinite())
    throw InvalidInput("a vertex of the product is not finite");
}

InsideTolerances tolerances(const Bodies& bodies, const ProductQualityOptions& options) {
  return {options.inside_tolerance * diagonal(bodies.source.vertices),
          options.inside_tolerance * diagonal(bodies.target.vertices)};
}

/// Of the same points of the product on both bodies.
struct BothClearances {
  Clearances source, target;

  NewPenetration new_penetration(const InsideTolerances& inside) const {
    return source.samples.distance.empty() ? new_penetration_of(source.vertices, target.vertices, inside)
                                           : new_penetration_of(source.samples, target.samples, inside);
  }
};

BothClearances clearances(const TriangleMesh& before, const Points& after, const Bodies& bodies,
                          const ProductQualityOptions& options) {
  SurfaceSamples samples;
  if (before.faces.cols() > 0) samples = sample_surface(before, options.samples);
  return {{bodies.from_source(before.vertices), bodies.from_source(positions(samples, before))},
          {bodies.from_target(after), bodies.from_target(positions(samples, {after, before.faces}))}};
}

}  // namespace

ProductQuality product_quality(const TriangleMesh& before, const Points& after, const Bodies& bodies,
                               const ProductQualityOptions& options) {
  require_product(before, after);
  ProductQuality quality;
  quality.vertices = static_cast<std::size_t>(after.cols());
  quality.faces = static_cast<std::size_t>(before.faces.cols());
  if (before.faces.cols() > 0) {
    quality.distortion = mesh_distortion(before, after);
    quality.self_intersections_before = self_intersections(before).size();
    quality.self_intersections_after = self_intersections({after, before.faces}).size();
  }
  const BothClearances found = clearances(before, after, bodies, options);
  const InsideTolerances inside = tolerances(bodies, options);
  compare_clearances(found.source.vertices, found.target.vertices, quality);
  quality.penetration_before = penetration(found.source, inside.source);
  quality.penetration_after = penetration(found.target, inside.target);
  quality.new_penetration = found.new_penetration(inside);
  return quality;
}

NewPenetration product_new_penetration(const TriangleMesh& before, const Points& after, const Bodies& bodies,
                                       const ProductQualityOptions& options) {
  require_product(before, after);
  return clearances(before, after, bodies, options).new_penetration(tolerances(bodies, options));
}

std::string to_string(const NewPenetration& new_penetration) {
  return format_number(100 * new_penetration.share, 3) +
         " % of it lies inside the target, though not inside the source before, at most " +
         format_number(new_penetration.deepest, 4) +
         " deep; the registered source is off the target there: look at it with `bespoke view`, and add "
         "anchors";
}

}  // namespace bespoke
