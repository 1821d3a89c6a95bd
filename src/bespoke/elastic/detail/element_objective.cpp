#include "bespoke/elastic/detail/element_objective.h"

#include <algorithm>
#include <cmath>

#include "bespoke/parallel.h"

namespace bespoke {
namespace {

Vector3 interpolated(const std::vector<Points>& values, const ElementPlace& place) {
  const Points& of_level = values[static_cast<std::size_t>(place.level)];
  Vector3 value = Vector3::Zero();
  for (std::size_t corner = 0; corner < 8; ++corner)
    value += place.weights[corner] * of_level.col(place.corners[corner]);
  return value;
}

/// Whether a flag is set at a corner of the place's cell. flags: one per point and level.
bool touches(const ElementPlace& place, const std::vector<std::vector<char>>& flags) {
  const std::vector<char>& of_level = flags[static_cast<std::size_t>(place.level)];
  return std::any_of(place.corners.begin(), place.corners.end(),
                     [&](int corner) { return of_level[static_cast<std::size_t>(corner)] != 0; });
}

}  // namespace

ElementObjective::ElementObjective(const NestedElements& elements, const ElementData& data,
                                   const DistortionBounds& bounds)
    : elements_(elements), bounds_(bounds), terms_(data.shares.size()) {
  parallel_for(terms_.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      terms_[i] = {elements.places(data.places.col(column)), data.wanted.col(column), data.shares[i]};
    }
  });
  set_shares(data.shares);
}

void ElementObjective::set_shares(const std::vector<double>& shares) {
  data_diagonal_.clear();
  for (const ElementLevel& level : elements_.levels()) data_diagonal_.emplace_back(level.points.size(), 0.0);
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    terms_[i].share = shares[i];
    for (const ElementPlace& place : terms_[i].places)
      for (std::size_t corner = 0; corner < 8; ++corner)
        data_diagonal_[static_cast<std::size_t>(place.level)]
                      [static_cast<std::size_t>(place.corners[corner])] +=
            shares[i] * place.weights[corner] * place.weights[corner];
  }
}

void ElementObjective::set_bounds(const DistortionBounds& bounds) {
  bounds_ = bounds;
  at_.resize(3, 0);
}

double ElementObjective::operator()(const Points& coefficients, Points& gradient) {
  if (coefficients.cols() != at_.cols() || coefficients.cols() == 0 || coefficients != at_) {
    at_ = coefficients;
    elements_.evaluate(coefficients, values_);
    distortion_gradients_.resize(values_.size());
    for (std::size_t k = 0; k < values_.size(); ++k) distortion_gradients_[k].setZero(3, values_[k].cols());
    distortion_ = add_distortion(elements_, values_, bounds_, distortion_gradients_, scratch_);
  }
  if (!std::isfinite(distortion_.energy)) return distortion_.energy;
  gradients_ = distortion_gradients_;
  double data = 0;
  for (const Term& term : terms_) {
    if (term.places.empty()) continue;
    const ElementPlace& place = term.places.back();
    const Vector3 off = interpolated(values_, place) - term.wanted;
    const double weight = weight_ * term.share;
    data += weight * off.squaredNorm() / 2;
    Points& of_level = gradients_[static_cast<std::size_t>(place.level)];
    for (std::size_t corner = 0; corner < 8; ++corner)
      of_level.col(place.corners[corner]) += weight * place.weights[corner] * off;
  }
  gradient = elements_.restricted(gradients_);
  return distortion_.energy + data;
}

void ElementObjective::damp(Points& step) const {
  constexpr double damping = 0.1;
  const std::vector<ElementLevel>& levels = elements_.levels();
  std::vector<std::vector<char>> flags;  // one per point and level
  for (const ElementLevel& level : levels) flags.emplace_back(level.points.size(), 0);
  const auto flag_corners = [&](std::size_t k, int cell) {
    for (const int corner : levels[k].corners[static_cast<std::size_t>(cell)])
      flags[k][static_cast<std::size_t>(corner)] = 1;
  };
  for (std::size_t k = 0; k < levels.size(); ++k)
    for (std::size_t number = 0; number < levels[k].finest.size(); ++number) {
      if (std::isfinite(distortion_.stiffness[k][number])) continue;
      const int cell = levels[k].finest[number];
      flag_corners(k, cell);
      LatticeCoordinates at = levels[k].cells[static_cast<std::size_t>(cell)];
      for (std::size_t coarser = k; coarser-- > 0;) {
        at = parent_of(at);
        flag_corners(coarser, levels[coarser].cell_table.find(at));
      }
    }
  for (std::size_t k = 0; k < levels.size(); ++k)
    for (std::size_t n = 0; n < levels[k].nodes.size(); ++n)
      if (flags[k][static_cast<std::size_t>(levels[k].point_of_node[n])])
        step.col(static_cast<Eigen::Index>(levels[k].first_unknown + n)) *= damping;
}

Eigen::VectorXd ElementObjective::inverse_diagonal() const {
  const std::vector<std::vector<double>> diagonal = distortion_diagonal(elements_, distortion_.stiffness);
  Eigen::VectorXd inverse(static_cast<Eigen::Index>(elements_.unknowns()));
  for (std::size_t k = 0; k < elements_.levels().size(); ++k) {
    const ElementLevel& level = elements_.levels()[k];
    for (std::size_t n = 0; n < level.nodes.size(); ++n) {
      const auto point = static_cast<std::size_t>(level.point_of_node[n]);
      inverse[static_cast<Eigen::Index>(level.first_unknown + n)] =
          1 / (diagonal[k][point] + weight_ * data_diagonal_[k][point]);
    }
  }
  return inverse;
}

std::vector<double> ElementObjective::residuals(const Points& coefficients) const {
  const std::vector<Points> values = elements_.values(coefficients);
  std::vector<double> result;
  for (const Term& term : terms_) {
    const Vector3 u = term.places.empty() ? Vector3::Zero() : interpolated(values, term.places.back());
    result.push_back((u - term.wanted).norm());
  }
  return result;
}

std::vector<std::size_t> ElementObjective::squeezed(const Points& coefficients,
                                                    const DistortionBounds& bounds) const {
  const std::vector<std::vector<std::size_t>> cells =
      cells_beyond(elements_, elements_.values(coefficients), bounds);
  std::vector<std::vector<char>> flags;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const ElementLevel& level = elements_.levels()[k];
    flags.emplace_back(level.points.size(), 0);
    for (const std::size_t number : cells[k])
      for (const int corner : level.corners[static_cast<std::size_t>(level.finest[number])])
        flags[k][static_cast<std::size_t>(corner)] = 1;
  }
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < terms_.size(); ++i)
    if (std::any_of(terms_[i].places.begin(), terms_[i].places.end(),
                    [&](const ElementPlace& place) { return touches(place, flags); }))
      found.push_back(i);
  return found;
}

std::size_t ElementObjective::outside() const {
  return static_cast<std::size_t>(
      std::count_if(terms_.begin(), terms_.end(), [](const Term& term) { return term.places.empty(); }));
}

}  // namespace bespoke
