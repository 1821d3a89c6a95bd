#include "bespoke/clearance/detail/missed_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace bespoke {
namespace {

constexpr std::size_t max_places = 10;

constexpr double nothing_needed = -std::numeric_limits<double>::infinity();

// Of the obstacle's step: where distances are larger, their uncertainty is not what decides.
constexpr double near_in_steps = 1;

Points columns_of(const Points& points, const std::vector<int>& columns) {
  Points some(3, static_cast<Eigen::Index>(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i)
    some.col(static_cast<Eigen::Index>(i)) = points.col(columns[i]);
  return some;
}

void append_columns(const Points& from, const std::vector<int>& columns, Points& to) {
  const Eigen::Index before = to.cols(), more = static_cast<Eigen::Index>(columns.size());
  to.conservativeResize(3, before + more);
  to.rightCols(more) = columns_of(from, columns);
}

}  // namespace

SampleDistances::SampleDistances(const SourceSamples& samples, const std::vector<Obstacle>& obstacles)
    : samples_(samples.samples), own_(static_cast<int>(samples_->count())), obstacles_(obstacles) {
  for (const Obstacle& obstacle : obstacles) {
    planes_.push_back(obstacle.planes ? obstacle.planes(samples.places.points()) : SidePlanes());
    required_.push_back(obstacle.planes ? planes_.back().required : obstacle.required(samples.places));
    distance_.emplace_back(required_.back().size(), std::numeric_limits<double>::infinity());
    least_.emplace_back(required_.back().size(), nothing_needed);
  }
}

void SampleDistances::look(const Points& on_target) {
  std::vector<char> moved(static_cast<std::size_t>(on_target.cols()), 1);
  if (looked_.cols() == on_target.cols())
    for (std::size_t v = 0; v < moved.size(); ++v) {
      const auto column = static_cast<Eigen::Index>(v);
      moved[v] = looked_.col(column) != on_target.col(column);
    }
  looked_ = on_target;
  std::vector<int> columns;
  for (int i = 0; i < static_cast<int>(samples().count()); ++i)
    if (moved[static_cast<std::size_t>(samples().vertices(0, i))] ||
        moved[static_cast<std::size_t>(samples().vertices(1, i))] ||
        moved[static_cast<std::size_t>(samples().vertices(2, i))])
      columns.push_back(i);
  const Points places = places_of(samples(), columns, on_target);
  for (std::size_t o = 0; o < obstacles_.size(); ++o) {
    const auto [distance, uncertainty] = distances(o, columns, places);
    const double near = near_in_steps * obstacles_[o].step;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const auto column = static_cast<std::size_t>(columns[i]);
      distance_[o][column] = distance[i];
      const bool counts = !uncertainty.empty() && required_[o][column] >= 0 && distance[i] <= near;
      least_[o][column] = counts ? uncertainty[i] : nothing_needed;
    }
  }
}

UncertainDistances SampleDistances::distances(std::size_t obstacle, const std::vector<int>& columns,
                                              const Points& places) const {
  const Obstacle& own = obstacles_[obstacle];
  if (own.with_uncertainty) return own.with_uncertainty(places);
  if (!own.planes) return {own.distance(places), {}};
  const SidePlanes& planes = planes_[obstacle];
  std::vector<double> found(columns.size());
  for (std::size_t i = 0; i < columns.size(); ++i)
    found[i] = planes.normals.col(columns[i])
                   .dot(places.col(static_cast<Eigen::Index>(i)) - planes.origins.col(columns[i]));
  return {std::move(found), {}};
}

void SampleDistances::append(const SampleDistances& other, const std::vector<int>& columns) {
  ProductSamples all = samples();
  bespoke::append(other.samples(), columns, all);
  samples_ = std::make_shared<const ProductSamples>(std::move(all));
  for (std::size_t o = 0; o < obstacles_.size(); ++o)
    for (const int column : columns) {
      required_[o].push_back(other.required_[o][static_cast<std::size_t>(column)]);
      distance_[o].push_back(other.distance_[o][static_cast<std::size_t>(column)]);
      least_[o].push_back(other.least_[o][static_cast<std::size_t>(column)]);
    }
  for (std::size_t o = 0; o < obstacles_.size(); ++o) {
    if (!obstacles_[o].planes) continue;
    append_columns(other.planes_[o].origins, columns, planes_[o].origins);
    append_columns(other.planes_[o].normals, columns, planes_[o].normals);
  }
}

double SampleDistances::max_missing(Eigen::Index sample) const {
  double most = 0;
  for (std::size_t o = 0; o < obstacles_.size(); ++o)
    if (!obstacles_[o].is_soft) most = std::max(most, missing(o, sample));
  return most;
}

std::vector<int> SampleDistances::missed() const {
  std::vector<int> columns;
  for (int i = 0; i < static_cast<int>(samples().count()); ++i)
    for (std::size_t o = 0; o < obstacles_.size(); ++o)
      if (!obstacles_[o].is_soft && misses(o, i)) {
        columns.push_back(i);
        break;
      }
  return columns;
}

MissedDistances SampleDistances::count() const {
  MissedDistances count;
  for (const int i : missed()) {
    if (i >= own_) break;
    ++count.samples;
    bool is_inside = false, is_breach = false;
    for (std::size_t o = 0; o < obstacles_.size(); ++o) {
      if (obstacles_[o].is_soft || !misses(o, i)) continue;
      count.most = std::max(count.most, missing(o, i));
      is_breach = is_breach || obstacles_[o].short_is_breach;
      // Of layers pairs of faces tell.
      is_inside = is_inside || (!obstacles_[o].planes && required(o, i) >= 0 &&
                                distance_[o][static_cast<std::size_t>(i)] < 0);
    }
    if (is_inside) ++count.inside;
    if (is_inside || is_breach) ++count.breaches;
  }
  return count;
}

bool CorrectionSamples::constrain_what_misses() {
  const std::vector<int> missed = checks_.missed();
  std::vector<int> further;
  for (const int column : missed)
    if (!std::exchange(is_constrained_[static_cast<std::size_t>(column)], 1)) further.push_back(column);
  distances_.append(checks_, further);
  return !missed.empty();
}

MissedDistances CorrectionSamples::count() const {
  const MissedDistances a = distances_.count(), b = checks_.count();
  return {a.samples + b.samples, a.inside + b.inside, a.breaches + b.breaches, std::max(a.most, b.most)};
}

namespace {

// Of what is missing: within so much of it a product with space has it.
constexpr double space_share = 1.5;
constexpr int space_rings = 6;

/// What the obstacle leaves there, on rings around the place in 26 directions.
MissedPlace missed_place(const Obstacle& obstacle, const Vector3& place, double missing, double required) {
  MissedPlace missed{obstacle.name, place, missing, 1};
  if (obstacle.planes) return missed;
  std::vector<Vector3> around;
  for (int ring = 1; ring <= space_rings; ++ring)
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z)
          if (x != 0 || y != 0 || z != 0)
            around.push_back(place +
                             space_share * missing * ring / space_rings * Vector3(x, y, z).normalized());
  const std::vector<double> distances = obstacle.distance(
      Eigen::Map<const Points>(around.front().data(), 3, static_cast<Eigen::Index>(around.size())));
  missed.space = *std::max_element(distances.begin(), distances.end());
  missed.has_space = *missed.space >= required - obstacle.tolerance;
  return missed;
}

}  // namespace

std::vector<MissedPlace> worst_places(const SampleDistances& distances, const Points& on_target,
                                      const std::vector<Obstacle>& obstacles, double radius) {
  struct Miss {
    double missing;
    int sample;
    std::size_t obstacle;
  };
  std::vector<Miss> misses;
  for (const int i : distances.missed())
    for (std::size_t o = 0; o < obstacles.size(); ++o)
      if (!obstacles[o].is_soft && distances.misses(o, i)) misses.push_back({distances.missing(o, i), i, o});
  std::stable_sort(misses.begin(), misses.end(),
                   [](const Miss& a, const Miss& b) { return a.missing > b.missing; });
  const Points places = places_of(distances.samples(), on_target);
  std::vector<MissedPlace> worst;
  for (const Miss& miss : misses) {
    const Vector3 place = places.col(miss.sample);
    const auto near = std::find_if(worst.begin(), worst.end(), [&](const MissedPlace& found) {
      return (found.place - place).norm() < radius;
    });
    if (near != worst.end())
      ++near->samples;
    else if (worst.size() < max_places)
      worst.push_back(missed_place(obstacles[miss.obstacle], place, miss.missing,
                                   distances.required(miss.obstacle, miss.sample)));
  }
  return worst;
}

}  // namespace bespoke
