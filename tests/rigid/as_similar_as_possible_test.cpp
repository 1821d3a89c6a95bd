#include "bespoke/rigid/as_similar_as_possible.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bespoke/error.h"
#include "bespoke/rigid/similarity_alignment.h"
#include "support/random_points.h"

namespace bespoke {
namespace {

/// Ten nodes in a ring, each linked to the two on either side.
struct Ring {
  static constexpr int count = 10;
  Points rest = test::random_points(count, 7);
  AsSimilarAsPossible graph{edges()};

  GraphEdges edges() const {
    GraphEdges all(count);
    for (int i = 0; i < count; ++i)
      for (const int step : {1, 2, count - 2, count - 1}) {
        const int other = (i + step) % count;
        all[static_cast<std::size_t>(i)].push_back({other, rest.col(other) - rest.col(i), 0.5 + 0.1 * step});
      }
    return all;
  }

  double energy(const Points& places, double stiffness, double smoothness) const {
    double sum = 0;
    for (int i = 0; i < count; ++i)
      for (const auto& [other, edge, weight] : graph.edges()[static_cast<std::size_t>(i)]) {
        const Matrix3& own = graph.similarities[static_cast<std::size_t>(i)];
        sum += stiffness * weight * (places.col(other) - places.col(i) - own * edge).squaredNorm() +
               smoothness * (own - graph.similarities[static_cast<std::size_t>(other)]).squaredNorm();
      }
    return sum;
  }
};

const Similarity similarity{2, test::random_rotation(3), Vector3(3, 0, -1)};

TEST(AsSimilarAsPossible, FindsTheSimilarityThatMovesAllOfIt) {
  Ring ring;
  ring.graph.fit_similarities(similarity * ring.rest);
  for (const Matrix3& found : ring.graph.similarities)
    EXPECT_LT((found - similarity.scale * similarity.rotation).norm(), 1e-12);
}

TEST(AsSimilarAsPossible, SweepsLowerTheEnergyOfSmoothSimilarities) {
  constexpr double smoothness = 0.3;
  Ring ring;
  const Points places = ring.rest + 0.5 * test::random_points(Ring::count, 8);
  double last = ring.energy(places, 1, smoothness);
  for (int sweep = 0; sweep < 5; ++sweep) {
    ring.graph.fit_similarities(places, smoothness);
    const double now = ring.energy(places, 1, smoothness);
    EXPECT_LT(now, last) << sweep;
    last = now;
  }
}

TEST(AsSimilarAsPossible, PlacesAreTheMinimum) {
  constexpr double stiffness = 3, step = 1e-4;
  Ring ring;
  ring.graph.fit_similarities(similarity * ring.rest + 0.3 * test::random_points(Ring::count, 9));
  const Points goals = 5 * test::random_points(2, 10);
  const std::vector<SoftConstraint> constraints{{{{0, 0.25}, {3, 0.75}}, 2}, {{{5, 1}}, 0.5}};
  ring.graph.set_constraints(constraints, stiffness);
  const auto energy = [&](const Points& x) {
    double sum = ring.energy(x, stiffness, 0);
    for (Eigen::Index k = 0; k < goals.cols(); ++k) {
      Vector3 off = -goals.col(k);
      for (const auto& [node, share] : constraints[static_cast<std::size_t>(k)].shares)
        off += share * x.col(node);
      sum += constraints[static_cast<std::size_t>(k)].weight * off.squaredNorm();
    }
    return sum;
  };
  const Points places = ring.graph.places(goals);
  const double least = energy(places);
  for (int trial = 0; trial < 20; ++trial)
    EXPECT_GT(energy(places + step * test::random_points(Ring::count, 20 + static_cast<unsigned>(trial))),
              least);
}

TEST(AsSimilarAsPossible, RefusesPlacesThatNothingDetermines) {
  AsSimilarAsPossible apart(GraphEdges(2));
  EXPECT_THROW(apart.set_constraints({{{{0, 1.0}}, 1}}, 1), SolverError);
}

}  // namespace
}  // namespace bespoke
