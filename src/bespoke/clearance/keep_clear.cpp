#include "bespoke/clearance/keep_clear.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bespoke/clearance/detail/draw_near.h"
#include "bespoke/clearance/detail/prepared_data.h"
#include "bespoke/error.h"
#include "bespoke/number_format.h"
#include "bespoke/stopwatch.h"

namespace bespoke {
namespace {

// Corrections of garments take three to five rounds, after each look at 16 samples a face one or two more.
constexpr int rounds_of_a_solve = 12;
constexpr int max_checks = 4;

// Of the least tolerance: how far faces that are parted are apart at least.
constexpr double parted_share = 0.2;

// Of the product's diagonal: places nearer than this are one.
constexpr double place_radius = 0.03;

constexpr int message_digits = 4;

void require_sizes(const PreparedProduct& product, const Points& carried) {
  if (carried.cols() != product.mesh().vertices.cols())
    throw InvalidInput("keep_clear got " + std::to_string(carried.cols()) + " carried vertices of " +
                       std::to_string(product.mesh().vertices.cols()));
  if (!carried.allFinite()) throw InvalidInput("a carried vertex is not finite");
}

Statistics edge_strain(const PreparedProduct::Data& product, const Points& after) {
  const TriangleMesh& before = product.mesh;
  const double size = growth(before, after);
  std::vector<double> strains;
  strains.reserve(product.edges.size());
  for (const MeshEdge& edge : product.edges) {
    const double was = (before.vertices.col(edge.a) - before.vertices.col(edge.b)).norm();
    const double is = (after.col(edge.a) - after.col(edge.b)).norm();
    if (was > 0 && is > 0) strains.push_back(std::abs(std::log(is / (size * was))));
  }
  return summarize(std::move(strains));
}

void describe_moves(const PreparedProduct& product, const Points& carried, const Correction& correction,
                    ClearedProduct& cleared) {
  ClearanceSummary& summary = cleared.summary;
  const std::vector<char> involved = correction.involved();
  std::vector<double> moves;
  for (Eigen::Index v = 0; v < carried.cols(); ++v) {
    if (!correction.moved()[static_cast<std::size_t>(v)]) continue;
    moves.push_back((cleared.vertices.col(v) - carried.col(v)).norm());
    if (!involved[static_cast<std::size_t>(v)])
      summary.largest_bystander = std::max(summary.largest_bystander, moves.back());
  }
  summary.moved = moves.size();
  summary.moves = summarize(std::move(moves));
  if (product.mesh().faces.cols() == 0) return;
  summary.strain_before = summary.strain_after = edge_strain(product.data(), carried);
  if (summary.moved == 0) return;
  summary.strain_after = edge_strain(product.data(), cleared.vertices);
}

/// Those of the product, and those nearest to its layers.
SourceSamples with_nearest_samples(const PreparedProduct::Data& data,
                                   const std::vector<Obstacle>& obstacles) {
  ProductSamples samples = *data.checks.samples;
  for (const Obstacle& obstacle : obstacles) {
    if (!obstacle.layer) continue;
    const TriangleMesh& layer = obstacle.layer->before;
    const Points places = places_of(constraint_samples(layer, Eigen::Matrix2Xi(2, 0), 0), layer.vertices);
    append(nearest_samples(data.mesh, places, obstacle.layer_reach), samples);
  }
  return {std::move(samples), data.mesh};
}

SampleDistances checks_of(const PreparedProduct::Data& data, const std::vector<Obstacle>& obstacles) {
  const bool any_layer = std::any_of(obstacles.begin(), obstacles.end(),
                                     [](const Obstacle& one) { return one.layer != nullptr; });
  if (!any_layer) return {data.checks, obstacles};
  return {with_nearest_samples(data, obstacles), obstacles};
}

double parting_margin(const std::vector<Obstacle>& obstacles) {
  double least = std::numeric_limits<double>::infinity();
  for (const Obstacle& obstacle : obstacles) least = std::min(least, obstacle.tolerance);
  return std::isfinite(least) ? parted_share * least : 0;
}

}  // namespace

ClearedProduct keep_clear(const PreparedProduct& product, const Points& carried,
                          const std::vector<Obstacle>& obstacles) {
  require_sizes(product, carried);
  const PreparedProduct::Data& data = product.data();
  ClearedProduct cleared;
  ClearanceSummary& summary = cleared.summary;
  summary.vertices = static_cast<std::size_t>(carried.cols());
  Stopwatch watch;
  SampleDistances checks = checks_of(data, obstacles);
  summary.looked_at = static_cast<std::size_t>(data.samples.samples->count() + checks.samples().count());
  checks.look(carried);
  summary.check_seconds = watch.seconds();
  watch = {};
  SampleDistances distances(data.samples, obstacles);
  distances.look(carried);
  CorrectionSamples samples(distances, checks);
  summary.before = samples.count();
  Correction correction(data, carried, obstacles);
  correction.solve(distances, rounds_of_a_solve);
  summary.solve_seconds = watch.seconds();
  for (int look = 0; look < max_checks; ++look) {
    watch = {};
    samples.look_at_checks(correction.vertices());
    summary.check_seconds += watch.seconds();
    watch = {};
    if (!samples.constrain_what_misses()) break;
    correction.solve(distances, rounds_of_a_solve / 2);
    summary.solve_seconds += watch.seconds();
  }
  watch = {};
  FacePassages passages(data.mesh, carried, obstacles);
  FacePairs left = part_faces(passages, parting_margin(obstacles), correction, samples);
  if (std::any_of(obstacles.begin(), obstacles.end(), [](const Obstacle& one) { return one.is_soft; }))
    left = draw_near(passages, left, correction, samples);
  summary.solve_seconds += watch.seconds();
  watch = {};
  summary.new_self_intersections = passages.of_product(left).size();
  summary.layers = passages.of_layers(left);
  summary.passed_through = passages.places(left, place_radius * diagonal(carried));
  cleared.vertices = correction.vertices();
  samples.look_at_checks(cleared.vertices);
  summary.after = samples.count();
  samples.constrain_what_misses();
  summary.places = worst_places(distances, cleared.vertices, obstacles, place_radius * diagonal(carried));
  describe_moves(product, carried, correction, cleared);
  summary.check_seconds += watch.seconds();
  return cleared;
}

namespace {

std::string number(double value) { return format_number(value, message_digits); }

std::string place_text(const Vector3& place) {
  return "(" + number(place[0]) + ", " + number(place[1]) + ", " + number(place[2]) + ")";
}

std::string missed_text(const MissedDistances& missed) {
  if (missed.samples == 0) return "none misses its distance";
  return std::to_string(missed.samples) + " miss their distance by up to " + number(missed.most) + ", " +
         std::to_string(missed.inside) + " of them inside that were outside";
}

}  // namespace

std::string to_string(const ClearanceSummary& summary) {
  std::string text = "clearance: of " + std::to_string(summary.looked_at) + " samples " +
                     missed_text(summary.before) + "; corrected, " + missed_text(summary.after);
  text +=
      "\nmoved " + std::to_string(summary.moved) + " of " + std::to_string(summary.vertices) + " vertices";
  if (summary.moved > 0)
    text += " by p50 " + number(summary.moves.median) + ", p95 " + number(summary.moves.p95) + ", max " +
            number(summary.moves.max) + "; strain of the edges p95 " + number(summary.strain_before.p95) +
            " before, " + number(summary.strain_after.p95) + " after, max " +
            number(summary.strain_before.max) + " and " + number(summary.strain_after.max);
  if (summary.new_self_intersections > 0)
    text += "\n" + std::to_string(summary.new_self_intersections) +
            " pairs of its faces pass through each other that did not before";
  for (const PassedThrough& passed : summary.passed_through)
    text += "\npasses through " + passed.other + " at " + place_text(passed.place) + ", " +
            std::to_string(passed.pairs) + " pairs of faces, where it did not before";
  for (const MissedPlace& place : summary.places) {
    text += (place.has_space ? "\nheld back at " : "\nno space at ") + place_text(place.place) + ": " +
            number(place.missing) + " short of its distance from " + place.obstacle + ", at " +
            std::to_string(place.samples) + " samples";
    if (place.has_space)
      text += "; there is space beside it, which no push reaches: it was carried too deep, or is too stiff";
    else if (place.space && *place.space <= 0)
      text += "; all around is inside";
    else if (place.space)
      text += "; between its sides there is " + number(*place.space);
  }
  return text;
}

}  // namespace bespoke
