#include "bespoke/clearance/detail/draw_near.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace bespoke {
namespace {

// Gradients of what is drawn are those of where it comes to lie.
constexpr int draws = 3;

// Draws are shortened where they do harm, to nothing in four rounds; what is near follows.
constexpr int max_rounds = 16;

// What was shortened for the sake of a neighbour may come nearer when that has moved.
constexpr int max_passes_of_draws = 2;

/// By how much samples miss what they must not.
class Misses {
 public:
  explicit Misses(const SampleDistances& distances) : distances_(distances), before_(amounts()) {}

  /// The vertices of those that miss more than at first.
  void add_new(std::vector<int>& vertices) const {
    const std::vector<double> now = amounts();
    for (std::size_t i = 0; i < now.size(); ++i) {
      if (!(now[i] > (i < before_.size() ? before_[i] : 0))) continue;
      for (const int vertex : distances_.samples().vertices.col(static_cast<Eigen::Index>(i)))
        vertices.push_back(vertex);
    }
  }

 private:
  std::vector<double> amounts() const {
    std::vector<double> amounts(static_cast<std::size_t>(distances_.samples().count()), 0);
    for (const int column : distances_.missed())
      amounts[static_cast<std::size_t>(column)] = distances_.max_missing(column);
    return amounts;
  }

  const SampleDistances& distances_;
  std::vector<double> before_;
};

/// One pass. Whether it was taken.
bool draw(FacePassages& passages, FacePairs& left, Correction& correction, CorrectionSamples& samples) {
  const NodeVectors before = correction.displacement();
  const Misses at_constraints(samples.distances()), at_checks(samples.checks());
  const auto look = [&] {
    const Points vertices = correction.vertices();
    samples.look_at_checks(vertices);
    passages.move_to(vertices);
  };
  for (int round = 0; round < draws; ++round) correction.draw(before, samples.distances());
  const NodeVectors further = correction.displacement() - before;
  Eigen::VectorXd shares = Eigen::VectorXd::Ones(further.rows());
  for (int round = 0; round < max_rounds; ++round) {
    correction.move_to(before + shares.asDiagonal() * further, samples.distances());
    look();
    FacePairs pairs = passages.found();
    FacePairs more;
    std::set_difference(pairs.begin(), pairs.end(), left.begin(), left.end(), std::back_inserter(more));
    std::vector<int> harmed;
    for (const auto& pair : more) passages.add_vertices(pair, harmed);
    at_constraints.add_new(harmed);
    at_checks.add_new(harmed);
    if (harmed.empty()) {
      left = std::move(pairs);
      return true;
    }
    correction.shorten_draws(harmed, shares);
  }
  correction.move_to(before, samples.distances());
  look();
  return false;
}

}  // namespace

FacePairs draw_near(FacePassages& passages, FacePairs left, Correction& correction,
                    CorrectionSamples& samples) {
  for (int pass = 0; pass < max_passes_of_draws && draw(passages, left, correction, samples); ++pass)
    continue;
  return left;
}

}  // namespace bespoke
