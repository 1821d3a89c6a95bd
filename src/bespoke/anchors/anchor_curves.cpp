#include "bespoke/anchors/anchor_curves.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "bespoke/anchors/detail/isotonic_regression.h"
#include "bespoke/error.h"
#include "bespoke/rigid/rigid_alignment.h"

namespace bespoke {
namespace {

/// Places at which a closed curve without fixed points may begin.
constexpr int starts = 180;
constexpr std::size_t pairs_that_fix_a_turn = 3;

/// Of the spacing: nearer to one another, two pairs leave the warp's equations singular, or bend it sharply.
constexpr double too_near = 0.5;

/// Of their even spacing on the target: no nearer do neighbours slide together. Where the surfaces disagree
/// with a curve, nearest places bunch and change their order, which no surface follows without folds.
constexpr double min_gap = 0.25;

Eigen::Index segments(const Points& polyline, bool closed) { return polyline.cols() - (closed ? 0 : 1); }

Vector3 end_of(const Points& polyline, Eigen::Index segment) {
  return polyline.col((segment + 1) % polyline.cols());
}

/// Length from the first point to every point, and, behind them, of the whole.
std::vector<double> lengths_up_to(const Points& polyline, bool closed) {
  std::vector<double> lengths{0};
  for (Eigen::Index i = 0; i < segments(polyline, closed); ++i)
    lengths.push_back(lengths.back() + (end_of(polyline, i) - polyline.col(i)).norm());
  return lengths;
}

double share_of_point(const Points& polyline, bool closed, int point) {
  const std::vector<double> lengths = lengths_up_to(polyline, closed);
  return lengths[static_cast<std::size_t>(point)] / lengths.back();
}

/// Shares of the length of a and of b that belong together, rising; linear between them.
struct Knot {
  double a = 0, b = 0;
};

double wrapped(double share) { return share - std::floor(share); }

/// Where b begins, and which way it runs, if it is to lie as a does under a motion.
std::vector<Knot> best_start(const AnchorCurve& curve, const RigidTransform& target_from_source) {
  const auto places = [](const Points& polyline) {
    Points result(3, starts);
    for (int i = 0; i < starts; ++i) result.col(i) = point_along(polyline, true, double(i) / starts);
    return result;
  };
  const Points moved = target_from_source * places(curve.a), found = places(curve.b);
  double least = std::numeric_limits<double>::infinity();
  std::vector<Knot> best;
  for (const int direction : {1, -1})
    for (int start = 0; start < starts; ++start) {
      double sum = 0;
      for (int i = 0; i < starts; ++i)
        sum += (found.col((start + direction * i + starts) % starts) - moved.col(i)).squaredNorm();
      if (sum >= least) continue;
      least = sum;
      const double begin = double(start) / starts;
      best = {{0, begin}, {1, begin + direction}};
    }
  return best;
}

std::vector<Knot> knots_of(const AnchorCurve& curve, const Anchors& given) {
  std::vector<Knot> knots;
  for (const auto& [a, b] : curve.fixed)
    knots.push_back({share_of_point(curve.a, curve.closed, a), share_of_point(curve.b, curve.closed, b)});
  if (curve.closed && !knots.empty()) {
    knots.push_back({knots.front().a + 1, knots.front().b + 1});
    return knots;
  }
  if (curve.closed) {
    if (given.pairs.size() < pairs_that_fix_a_turn)
      throw InvalidInput("where the closed curve \"" + curve.name + "\" begins on the target follows from " +
                         std::to_string(pairs_that_fix_a_turn) + " pairs that are not collinear, there are " +
                         std::to_string(given.pairs.size()) +
                         "; add pairs, or a \"fixed\" point to the curve");
    return best_start(curve,
                      align_rigidly(source_points(given), target_points(given), spline_weights(given)));
  }
  if (knots.empty() || knots.front().a > 0) knots.insert(knots.begin(), {0, 0});
  if (knots.back().a < 1) knots.push_back({1, 1});
  return knots;
}

}  // namespace

Vector3 point_along(const Points& polyline, bool closed, double share) {
  const std::vector<double> lengths = lengths_up_to(polyline, closed);
  const double length = share * lengths.back();
  const auto next = std::upper_bound(lengths.begin() + 1, lengths.end() - 1, length);
  const auto segment = static_cast<Eigen::Index>(next - lengths.begin()) - 1;
  const double own = *next - *(next - 1);
  const double along = own > 0 ? std::clamp((length - *(next - 1)) / own, 0.0, 1.0) : 0;
  return (1 - along) * polyline.col(segment) + along * end_of(polyline, segment);
}

Vector3 nearest_along(const Points& polyline, bool closed, const Vector3& x) {
  Vector3 nearest = polyline.col(0);
  for (Eigen::Index i = 0; i < segments(polyline, closed); ++i) {
    const Vector3 begin = polyline.col(i), way = end_of(polyline, i) - begin;
    const double squared = way.squaredNorm();
    const double along = squared > 0 ? std::clamp((x - begin).dot(way) / squared, 0.0, 1.0) : 0;
    const Vector3 foot = begin + along * way;
    if ((foot - x).squaredNorm() < (nearest - x).squaredNorm()) nearest = foot;
  }
  return nearest;
}

namespace {

/// The same for shares that go on past the beginning of a closed curve, and for rounding at the ends.
Vector3 place_at(const Points& polyline, bool closed, double share) {
  return point_along(polyline, closed, closed ? wrapped(share) : std::clamp(share, 0.0, 1.0));
}

/// Between places, a component of a displacement changes by at most this much of their distance: all three
/// together by less than a half, so that nothing flips.
constexpr double steepest = 0.25;

/// The displacement required at places[i], made gentle: each component is the mean of the largest and the
/// least function of that steepness below and above all required ones (McShane 1934), which leaves what is
/// gentle as it is; near held places no more than their distance allows.
Vector3 gentle_displacement(const Points& required, const Points& places, const Points& held,
                            Eigen::Index i) {
  const Eigen::RowVectorXd reach = steepest * (places.colwise() - places.col(i)).colwise().norm();
  const Vector3 most = (required.rowwise() + reach).rowwise().minCoeff();
  const Vector3 least = (required.rowwise() - reach).rowwise().maxCoeff();
  double allowed = std::numeric_limits<double>::infinity();
  if (held.cols() > 0) allowed = steepest * (held.colwise() - places.col(i)).colwise().norm().minCoeff();
  return ((most + least) / 2).cwiseMin(allowed).cwiseMax(-allowed);
}

/// The share, from `low` to `high`, of the place that is nearest to x. Shares of a closed curve go on past
/// its beginning.
double nearest_share(const Points& polyline, bool closed, const Vector3& x, double low, double high) {
  const std::vector<double> lengths = lengths_up_to(polyline, closed);
  double nearest = low, least = std::numeric_limits<double>::infinity();
  for (double turn = std::floor(low); turn <= std::floor(high); ++turn)
    for (Eigen::Index i = 0; i < segments(polyline, closed); ++i) {
      const auto segment = static_cast<std::size_t>(i);
      const double begin = turn + lengths[segment] / lengths.back();
      const double end = turn + lengths[segment + 1] / lengths.back();
      if (end < low || begin > high) continue;
      const Vector3 way = end_of(polyline, i) - polyline.col(i);
      const double squared = way.squaredNorm();
      const double along = squared > 0 ? (x - polyline.col(i)).dot(way) / squared : 0;
      const double share =
          std::clamp(begin + along * (end - begin), std::max(begin, low), std::min(end, high));
      const double part = end > begin ? (share - begin) / (end - begin) : 0;
      const double found = (polyline.col(i) + part * way - x).squaredNorm();
      if (found < least) nearest = share;
      least = std::min(found, least);
    }
  return nearest;
}

}  // namespace

double distance_from_polyline(const Points& polyline, bool closed, const Points& points) {
  double largest = 0;
  for (const auto& point : points.colwise())
    largest = std::max(largest, (nearest_along(polyline, closed, point) - point).norm());
  return largest;
}

CurvePairs::CurvePairs(const Anchors& given, double spacing) : given_(given) {
  if (!(spacing > 0)) throw InvalidInput("points along a curve need a spacing above 0");
  curves_ = std::exchange(given_.curves, {});
  for (std::size_t k = 0; k < given.curves.size(); ++k) {
    const AnchorCurve& curve = given.curves[k];
    const std::vector<Knot> knots = knots_of(curve, given);
    const double length = lengths_up_to(curve.a, curve.closed).back();
    const auto add = [&](double a, double b, bool is_fixed) {
      AnchorPair pair{curve.name + '[' + std::to_string(samples_.size()) + ']',
                      place_at(curve.a, curve.closed, a), place_at(curve.b, curve.closed, b)};
      if (is_taken(pair.a, k, is_fixed ? 0 : too_near * spacing)) return;
      samples_.push_back({k, std::move(pair), is_fixed, b});
    };
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
      const bool begins_fixed =
          !curve.fixed.empty() && (curve.closed || knots[i].a > 0 || curve.fixed[0].first == 0);
      const auto pieces = std::max(1.0, std::ceil((knots[i + 1].a - knots[i].a) * length / spacing));
      for (double piece = 0; piece < pieces; ++piece) {
        const double part = piece / pieces;
        add(knots[i].a + part * (knots[i + 1].a - knots[i].a),
            knots[i].b + part * (knots[i + 1].b - knots[i].b), piece == 0 && begins_fixed);
      }
    }
    if (!curve.closed)
      add(1, knots.back().b, !curve.fixed.empty() && curve.fixed.back().first == curve.a.cols() - 1);
  }
}

bool CurvePairs::is_taken(const Vector3& source, std::size_t curve, double distance) const {
  const auto is_near = [&](const AnchorPair& pair) { return (pair.a - source).norm() <= distance; };
  return std::any_of(given_.pairs.begin(), given_.pairs.end(), is_near) ||
         std::any_of(samples_.begin(), samples_.end(),
                     [&](const Sample& sample) { return sample.curve != curve && is_near(sample.pair); });
}

Anchors CurvePairs::pairs(double sigma) const {
  Anchors all = given_;
  for (const Sample& sample : samples_) {
    all.pairs.push_back(sample.pair);
    all.pairs.back().sigma = sample.is_fixed ? 0 : sigma;
  }
  return all;
}

void CurvePairs::slide(const Points& places, double reach) {
  for (std::size_t begin = 0, end = 0; begin < samples_.size(); begin = end) {
    while (end < samples_.size() && samples_[end].curve == samples_[begin].curve) ++end;
    slide_along({samples_.data() + begin, end - begin},
                places.middleCols(static_cast<Eigen::Index>(begin), static_cast<Eigen::Index>(end - begin)),
                reach);
  }
}

void CurvePairs::slide_along(std::span<Sample> samples, const Points& places, double reach) const {
  const AnchorCurve& curve = curves_[samples.front().curve];
  const double window = std::min(reach / lengths_up_to(curve.b, curve.closed).back(), 0.5);
  const double direction = samples.back().share < samples.front().share ? -1 : 1;
  // Rising where neighbours keep their least gap.
  std::vector<SlidingValue> values;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Sample& sample = samples[i];
    double low = sample.share - window, high = sample.share + window;
    if (!curve.closed) low = std::max(low, 0.0);
    if (!curve.closed) high = std::min(high, 1.0);
    const double share = sample.is_fixed ? sample.share
                                         : nearest_share(curve.b, curve.closed,
                                                         places.col(static_cast<Eigen::Index>(i)), low, high);
    values.push_back({direction * (share - min_gap * sample.share), sample.is_fixed});
  }
  // What follows the end of a closed curve is its beginning, one turn on.
  const std::vector<double> rising = curve.closed ? nearest_rising_round(values, 1 - min_gap)
                                                  : nearest_rising(values, -min_gap * samples.front().share,
                                                                   1 - min_gap * samples.back().share);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    Sample& sample = samples[i];
    if (sample.is_fixed) continue;
    sample.pair.b = place_at(curve.b, curve.closed, direction * rising[i] + min_gap * sample.share);
  }
}

void CurvePairs::give_way(const Points& places, const Points& held) {
  Points required(3, places.cols());
  for (Eigen::Index i = 0; i < places.cols(); ++i)
    required.col(i) = samples_[static_cast<std::size_t>(i)].pair.b - places.col(i);
  for (Eigen::Index i = 0; i < places.cols(); ++i) {
    Sample& sample = samples_[static_cast<std::size_t>(i)];
    if (!sample.is_fixed) sample.pair.b = places.col(i) + gentle_displacement(required, places, held, i);
  }
}

Points CurvePairs::sources() const {
  Points points(3, static_cast<Eigen::Index>(samples_.size()));
  for (std::size_t i = 0; i < samples_.size(); ++i)
    points.col(static_cast<Eigen::Index>(i)) = samples_[i].pair.a;
  return points;
}

}  // namespace bespoke
