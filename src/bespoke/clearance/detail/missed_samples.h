#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "bespoke/clearance/detail/prepared_data.h"
#include "bespoke/clearance/keep_clear.h"

namespace bespoke {

/// What the obstacles require of samples, and by how much they miss it.
class SampleDistances {
 public:
  SampleDistances(const SourceSamples& samples, const std::vector<Obstacle>& obstacles);

  /// Takes the vertices (3×n) as they lie on the target. Looks where they moved since the last time.
  void look(const Points& on_target);

  /// The direction in which the sample's distance grows, where it is known without looking; else zero.
  Vector3 gradient(std::size_t obstacle, Eigen::Index sample) const {
    return obstacles_[obstacle].planes ? Vector3(planes_[obstacle].normals.col(sample)) : Vector3::Zero();
  }

  /// Some of another's after these, which looked at the same vertices: they are constrained with them and not
  /// counted.
  void append(const SampleDistances& other, const std::vector<int>& columns);

  const ProductSamples& samples() const { return *samples_; }
  double required(std::size_t obstacle, Eigen::Index sample) const {
    return required_[obstacle][static_cast<std::size_t>(sample)];
  }
  /// Above the tolerance of the obstacle where the sample misses; mesh units.
  double missing(std::size_t obstacle, Eigen::Index sample) const {
    const auto at = static_cast<std::size_t>(sample);
    return std::max(required_[obstacle][at], least_[obstacle][at]) - distance_[obstacle][at];
  }
  /// The same where the sample needs no more than to stay outside, if it was.
  double missing_outside(std::size_t obstacle, Eigen::Index sample) const {
    const auto at = static_cast<std::size_t>(sample);
    return std::max(std::min(required_[obstacle][at], 0.0), least_[obstacle][at]) - distance_[obstacle][at];
  }
  bool misses(std::size_t obstacle, Eigen::Index sample) const {
    return missing(obstacle, sample) > obstacles_[obstacle].tolerance;
  }
  /// By what it misses obstacles that are not soft.
  double max_missing(Eigen::Index sample) const;
  /// Columns that miss what some obstacle requires.
  std::vector<int> missed() const;

  /// Of the samples that it was made with.
  MissedDistances count() const;

 private:
  UncertainDistances distances(std::size_t obstacle, const std::vector<int>& columns,
                               const Points& places) const;

  std::shared_ptr<const ProductSamples> samples_;
  int own_;  // of them, first
  const std::vector<Obstacle>& obstacles_;
  Points looked_;  // the vertices at the last look
  /// Of each obstacle, of each sample; `least`: what keeps it outside although the distance is uncertain.
  std::vector<std::vector<double>> required_, distance_, least_;
  std::vector<SidePlanes> planes_;  // of layers
};

/// What a correction is solved and checked by.
class CorrectionSamples {
 public:
  /// `distances`: constrained from the start; `checks`: looked at, as carried so far. Both must outlive it.
  CorrectionSamples(SampleDistances& distances, SampleDistances& checks)
      : distances_(distances),
        checks_(checks),
        is_constrained_(static_cast<std::size_t>(checks.samples().count()), 0) {}

  SampleDistances& distances() const { return distances_; }
  const SampleDistances& checks() const { return checks_; }

  /// The vertices (3×n) as they are.
  void look_at_checks(const Points& vertices) { checks_.look(vertices); }

  /// Checks that miss join what is constrained, each once. Whether any misses.
  bool constrain_what_misses();

  /// Of both, each sample once.
  MissedDistances count() const;

 private:
  SampleDistances& distances_;
  SampleDistances& checks_;
  std::vector<char> is_constrained_;  // of the checks
};

/// The worst places of what misses, one in a neighbourhood of `radius` (mesh units), ten at most.
std::vector<MissedPlace> worst_places(const SampleDistances& distances, const Points& on_target,
                                      const std::vector<Obstacle>& obstacles, double radius);

}  // namespace bespoke
