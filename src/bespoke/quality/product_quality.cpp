#include "bespoke/quality/product_quality.h"

#include <algorithm>
#include <cmath>

#include "bespoke/error.h"
#include "bespoke/number_format.h"
#include "bespoke/quality/detail/line_samples.h"
#include "bespoke/quality/detail/surface_samples.h"
#include "bespoke/quality/self_intersection.h"

namespace bespoke {
namespace {

struct Clearances {
  SignedDistance::Values vertices;
  SignedDistance::Values samples;  ///< on faces
  SignedDistance::Values on_lines;
};

/// What counts as inside, mesh units, and as nearer than before.
struct InsideTolerances {
  double source = 0, target = 0;
  double growth = 1;  ///< of the target's size over the source's
  double nearer = 0;  ///< mesh units, on the target
};

Penetration penetration(const Clearances& clearances, double tolerance) {
  const auto count_inside = [&](const SignedDistance::Values& values) {
    std::size_t inside = 0;
    for (std::size_t i = 0; i < values.distance.size(); ++i) inside += values.distance[i] < -tolerance;
    return inside;
  };
  const auto share_inside = [&](const SignedDistance::Values& values) {
    const std::size_t all = values.distance.size();
    return all == 0 ? 0 : static_cast<double>(count_inside(values)) / static_cast<double>(all);
  };
  Penetration result;
  result.vertices = count_inside(clearances.vertices);
  result.area_share = share_inside(clearances.samples);
  result.line_share = share_inside(clearances.on_lines);
  for (const SignedDistance::Values* values :
       {&clearances.vertices, &clearances.samples, &clearances.on_lines})
    for (const double distance : values->distance) result.deepest = std::max(result.deepest, -distance);
  return result;
}

/// The same places before and after.
NewPenetration new_penetration_of(const SignedDistance::Values& before, const SignedDistance::Values& after,
                                  const InsideTolerances& tolerances) {
  NewPenetration result;
  std::size_t count = 0;
  for (std::size_t i = 0; i < after.distance.size(); ++i) {
    const double nearer = tolerances.growth * before.distance[i] - after.distance[i];
    if (before.distance[i] < -tolerances.source || !(after.distance[i] < -tolerances.target) ||
        !(nearer > tolerances.nearer))
      continue;
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

void require_product(const MeasuredProduct& before, const Points& after) {
  const Points& vertices = before.mesh.vertices;
  if (after.cols() != vertices.cols())
    throw InvalidInput("product_quality got " + std::to_string(after.cols()) + " vertices after and " +
                       std::to_string(vertices.cols()) + " before");
  if (!vertices.allFinite() || !after.allFinite())
    throw InvalidInput("a vertex of the product is not finite");
}

InsideTolerances tolerances(const Bodies& bodies, const ProductQualityOptions& options) {
  constexpr double remeshing = 1e-3;  // of the target's diagonal: two meshes of one surface differ so
  const double source = diagonal(bodies.source.vertices), target = diagonal(bodies.target.vertices);
  return {options.inside_tolerance * source, options.inside_tolerance * target, target / source,
          remeshing * target};
}

/// Of the same points of the product on both bodies.
struct BothClearances {
  Clearances source, target;

  NewPenetration new_penetration(const InsideTolerances& inside) const {
    if (!source.samples.distance.empty()) return new_penetration_of(source.samples, target.samples, inside);
    if (!source.on_lines.distance.empty())
      return new_penetration_of(source.on_lines, target.on_lines, inside);
    return new_penetration_of(source.vertices, target.vertices, inside);
  }
};

BothClearances clearances(const MeasuredProduct& before, const Points& after, const Bodies& bodies,
                          const ProductQualityOptions& options) {
  const auto& [vertices, faces] = before.mesh;
  SurfaceSamples samples;
  if (faces.cols() > 0) samples = sample_surface(before.mesh, options.samples);
  const LineSamples on_lines = sample_lines(vertices, before.line_edges, options.line_samples);
  return {{bodies.from_source(vertices), bodies.from_source(positions(samples, before.mesh)),
           bodies.from_source(positions(on_lines, vertices))},
          {bodies.from_target(after), bodies.from_target(positions(samples, {after, faces})),
           bodies.from_target(positions(on_lines, after))}};
}

Spread line_length_ratios(const MeasuredProduct& before, const Points& after) {
  std::vector<double> ratios;
  for (std::size_t k = 0; k + 1 < before.line_edges.size(); k += 2) {
    const int a = before.line_edges[k], b = before.line_edges[k + 1];
    const double length = (before.mesh.vertices.col(a) - before.mesh.vertices.col(b)).norm();
    if (length > 0) ratios.push_back((after.col(a) - after.col(b)).norm() / length);
  }
  return spread(std::move(ratios));
}

}  // namespace

ProductQuality product_quality(const MeasuredProduct& before, const Points& after, const Bodies& bodies,
                               const ProductQualityOptions& options) {
  require_product(before, after);
  ProductQuality quality;
  quality.vertices = static_cast<std::size_t>(after.cols());
  quality.faces = static_cast<std::size_t>(before.mesh.faces.cols());
  quality.lines = before.line_edges.size() / 2;
  quality.line_lengths = line_length_ratios(before, after);
  if (before.mesh.faces.cols() > 0) {
    quality.distortion = mesh_distortion(before.mesh, after);
    quality.self_intersections_before = self_intersections(before.mesh).size();
    quality.self_intersections_after = self_intersections({after, before.mesh.faces}).size();
  }
  const BothClearances found = clearances(before, after, bodies, options);
  const InsideTolerances inside = tolerances(bodies, options);
  compare_clearances(found.source.vertices, found.target.vertices, quality);
  quality.penetration_before = penetration(found.source, inside.source);
  quality.penetration_after = penetration(found.target, inside.target);
  quality.new_penetration = found.new_penetration(inside);
  return quality;
}

NewPenetration product_new_penetration(const MeasuredProduct& before, const Points& after,
                                       const Bodies& bodies, const ProductQualityOptions& options) {
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
