#include "bespoke/surface_fit/graph/registration_energy.h"

#include <gtest/gtest.h>

#include "support/arithmetic.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using test::infinity;

const char* name_of(EnergyTerm term) {
  switch (term) {
    case EnergyTerm::data:
      return "data";
    case EnergyTerm::cuts:
      return "cuts";
    case EnergyTerm::anchors:
      return "anchors";
    case EnergyTerm::bending:
      return "bending";
    case EnergyTerm::shape:
      return "shape";
  }
  return "";
}

/// A sphere whose nodes are displaced at random, with goals of all kinds.
class RegistrationEnergyTest : public testing::Test {
 protected:
  RegistrationEnergyTest()
      : nodes_(make_deformation_nodes(sphere_, 0.5)),
        shape_(sphere_.vertices(Eigen::all, nodes_.vertices)),
        now_(0.1 * Points::Random(3, nodes_.size())) {
    const Points normals = vertex_normals(sphere_);
    for (int i = 0; i < vertices_.cols(); ++i) {
      vertices_.col(i) += nodes_.displacement(now_, i);
      planes_.push_back({i, sphere_.vertices.col(i) + 0.1 * Vector3::Random(),
                         (normals.col(i) + 0.2 * Vector3::Random()).normalized(), 0.01 * (i % 5),
                         0.1 * (i % 3)});
    }
    for (int i = 0; i < 7; ++i)
      cuts_.push_back({3 * i, 0.1, sphere_.vertices.col(3 * i) + 0.1 * Vector3::Random(),
                       Vector3::Random().normalized()});
    const ClosestPointTree tree(sphere_);
    for (const double weight : {infinity, 3.0, infinity})
      anchors_.push_back({nodes_.at_point(*tree.closest(Vector3::Random()), sphere_.faces),
                          0.2 * Vector3::Random(), weight});
  }

  EnergyInput input() const { return {surface_, nodes_, shape_, anchors_, settings_}; }

  Points gradient_of(EnergyTerm term, const RegistrationEnergy& energy) const {
    std::vector<std::vector<int>> all(static_cast<std::size_t>(nodes_.size()));
    for (auto& row : all)
      for (int node = 0; node < nodes_.size(); ++node) row.push_back(node);
    BlockSystem system(all, nodes_.rest);
    energy.add_step(term, system);
    return system.gradient(now_);
  }

  TriangleMesh sphere_ = shapes::icosphere(3);
  Points vertices_ = sphere_.vertices;
  NodeSurface surface_{sphere_, sphere_.vertices, vertex_areas(sphere_).sum()};
  DeformationNodes nodes_;
  Points shape_, now_;
  std::vector<FollowedAnchor> anchors_;
  std::vector<PlanePair> planes_;
  std::vector<BoundaryMatch> cuts_;
  NodeFitSettings settings_;
  NodeGoals goals_{vertices_, planes_, cuts_, 0.7, 2, {}, 1.5};
};

TEST_F(RegistrationEnergyTest, AStepOfEachTermFollowsItsGradient) {
  const RegistrationEnergy energy(input(), goals_, now_);
  constexpr double step = 1e-5;
  for (const EnergyTerm term : energy_terms) {
    const Points gradient = gradient_of(term, energy);
    const double largest = gradient.cwiseAbs().maxCoeff();
    EXPECT_GT(largest, 1e-6) << name_of(term);
    for (Eigen::Index k = 0; k < now_.size(); k += 5) {
      Points more = now_, less = now_;
      more.reshaped()[k] += step;
      less.reshaped()[k] -= step;
      const double difference = (energy.value(term, more) - energy.value(term, less)) / (2 * step);
      EXPECT_NEAR(gradient.reshaped()[k], difference, 1e-6 * largest) << name_of(term) << " at " << k;
    }
  }
}

TEST_F(RegistrationEnergyTest, NoTermIsNegativeAndNoneIsThereWithoutItsGoals) {
  const std::vector<PlanePair> no_planes;
  const std::vector<BoundaryMatch> no_cuts;
  const RegistrationEnergy energy(input(), goals_, now_);
  for (const EnergyTerm term : energy_terms) EXPECT_GT(energy.value(term, now_), 0) << name_of(term);
  anchors_.clear();
  const NodeGoals nothing{vertices_, no_planes, no_cuts, 0.7, 2};
  const RegistrationEnergy smooth(input(), nothing, now_);
  for (const EnergyTerm term : {EnergyTerm::data, EnergyTerm::cuts, EnergyTerm::anchors})
    EXPECT_EQ(smooth.value(term, now_), 0) << name_of(term);
}

TEST_F(RegistrationEnergyTest, ASimilarityOfTheWholeBendsAndStrainsNothing) {
  const Matrix3 turn = Eigen::AngleAxisd(0.4, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  const Points displacements = (1.2 * turn * nodes_.rest).colwise() + Vector3(4, 5, 6) - nodes_.rest;
  const RegistrationEnergy energy(input(), goals_, displacements);
  for (const EnergyTerm term : {EnergyTerm::bending, EnergyTerm::shape})
    EXPECT_LT(energy.value(term, displacements), 1e-3 * energy.value(term, displacements + 5 * now_))
        << name_of(term);
}

TEST_F(RegistrationEnergyTest, TheFartherAPairTheLessItPulls) {
  // As likely as not to be right at the scale: beyond, its force falls.
  const auto force = [&](double distance) {
    std::vector<PlanePair> planes;
    for (int i = 0; i < vertices_.cols(); ++i)
      planes.push_back(
          {i, vertices_.col(i) + 0.01 * vertex_normals(sphere_).col(i), vertex_normals(sphere_).col(i), 1});
    planes.push_back(
        {5, vertices_.col(5) + distance * vertex_normals(sphere_).col(5), vertex_normals(sphere_).col(5), 1});
    const NodeGoals goals{vertices_, planes, cuts_, 0.1, 2};
    const Points with = gradient_of(EnergyTerm::data, RegistrationEnergy(input(), goals, now_));
    planes.pop_back();
    return (with - gradient_of(EnergyTerm::data, RegistrationEnergy(input(), goals, now_))).norm();
  };
  EXPECT_GT(force(0.04), force(0.02));
  EXPECT_LT(force(1), force(0.04));
}

}  // namespace
}  // namespace bespoke
