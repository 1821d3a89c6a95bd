#include "bespoke/mapping/elastic_chain.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/mapping/affine_map.h"

namespace bespoke {

ElasticChain::ElasticChain(std::vector<std::shared_ptr<const ElasticMap>> steps) : steps_(std::move(steps)) {
  if (steps_.empty()) throw InvalidInput("a chain of elastic maps has no steps");
}

AffineMap ElasticChain::affine() const {
  AffineMap whole = steps_.front()->affine();
  for (std::size_t k = 1; k < steps_.size(); ++k) whole = compose(steps_[k]->affine(), whole);
  return whole;
}

// With A the affine parts so far and u what is left of them, the next step takes A x + u to
// A' (A x + u) + u'(A x + u): its displacement is A' u + u', zero where both are.
Points ElasticChain::displacement(const Points& x) const {
  Points u = steps_.front()->displacement(x);
  AffineMap affine = steps_.front()->affine();
  for (std::size_t k = 1; k < steps_.size(); ++k) {
    const AffineMap step = steps_[k]->affine();
    const Points own = steps_[k]->displacement(affine * x + u);
    u = (step.linear * u + own).eval();
    affine = compose(step, affine);
  }
  return u;
}

Points ElasticChain::displacement_gradient(const Points& x) const {
  Points gradient = steps_.front()->displacement_gradient(x);
  AffineMap affine = steps_.front()->affine();
  Points images = (*steps_.front())(x);
  for (std::size_t k = 1; k < steps_.size(); ++k) {
    const AffineMap step = steps_[k]->affine();
    const Points own = steps_[k]->displacement_gradient(images);
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      const Matrix3 inner = gradient.middleCols<3>(3 * i);
      const Matrix3 outer = own.middleCols<3>(3 * i);
      gradient.middleCols<3>(3 * i) = step.linear * inner + outer * (affine.linear + inner);
    }
    affine = compose(step, affine);
    if (k + 1 < steps_.size()) images = (*steps_[k])(images);
  }
  return gradient;
}

Support ElasticChain::support() const {
  if (steps_.size() == 1) return steps_.front()->support();
  Support support;
  AffineMap before;
  for (const auto& step : steps_) {
    const Support part = step->support();
    const AffineMap back = inverse(compose(part.frame, before));
    const double stretch = Eigen::JacobiSVD<Matrix3>(back.linear).singularValues()[0];
    for (const BallCloud& cloud : part.clouds)
      support.clouds.push_back({back * cloud.centers, stretch * cloud.radius});
    before = compose(step->affine(), before);
  }
  return support;
}

Points ElasticChain::at(const Points& x, double t) const {
  return std::move(at(x, std::vector<double>{t}).front());
}

std::vector<Points> ElasticChain::at(const Points& x, const std::vector<double>& times) const {
  const auto count = static_cast<double>(steps_.size());
  std::vector<std::size_t> step_of;
  for (const double t : times) {
    if (!std::isfinite(t))
      throw InvalidInput("a chain of elastic maps at t = " + std::to_string(t) + ": t must be finite");
    step_of.push_back(static_cast<std::size_t>(std::clamp(std::floor(t * count), 0.0, count - 1)));
  }
  std::vector<Points> frames(times.size());
  Points before = x;
  for (std::size_t k = 0; k < steps_.size(); ++k) {
    Points after = (*steps_[k])(before);
    for (std::size_t i = 0; i < times.size(); ++i) {
      if (step_of[i] != k) continue;
      const double fraction = times[i] * count - static_cast<double>(k);
      // Exact at the ends of a step.
      frames[i] = fraction == 0   ? before
                  : fraction == 1 ? after
                                  : Points((1 - fraction) * before + fraction * after);
    }
    before = std::move(after);
  }
  return frames;
}

}  // namespace bespoke
