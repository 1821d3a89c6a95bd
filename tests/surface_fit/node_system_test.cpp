#include "bespoke/surface_fit/graph/node_system.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/arithmetic.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using test::infinity;

class NodeSystemTest : public testing::Test {
 protected:
  NodeSystem system(const std::vector<NodeAnchor>& anchors) const {
    return {{sphere_, sphere_.vertices, vertex_areas(sphere_).sum()},
            make_deformation_nodes(sphere_, 0.3),
            anchors,
            settings_};
  }
  NodeAnchor anchor(int vertex, const Vector3& displacement, double weight = infinity) const {
    return {*ClosestPointTree(sphere_).closest(sphere_.vertices.col(vertex)), displacement, weight};
  }
  Points solve(NodeSystem&& system, const std::vector<PlanePair>& planes = {}, double smoothing = 1) const {
    return system.solve({sphere_.vertices, planes, {}, smoothing, 1});
  }

  TriangleMesh sphere_ = shapes::icosphere(4);
  NodeFitSettings settings_;
};

TEST_F(NodeSystemTest, CarriesAllAlongWithAnchorsThatMoveAlike) {
  const Vector3 shift(0.3, -0.2, 0.5);
  const Points moved = solve(system({anchor(0, shift), anchor(40, shift), anchor(90, shift, 3)}));
  EXPECT_LT((moved.colwise() - shift - sphere_.vertices).colwise().norm().maxCoeff(), 1e-6);
}

TEST_F(NodeSystemTest, LeavesASurfaceInItsOwnPlanes) {
  std::vector<PlanePair> planes;
  const Points normals = vertex_normals(sphere_);
  for (int i = 0; i < sphere_.vertices.cols(); ++i)
    planes.push_back({i, sphere_.vertices.col(i), normals.col(i), 1e-3});
  EXPECT_LT((solve(system({}), planes) - sphere_.vertices).cwiseAbs().maxCoeff(), 1e-9);
}

TEST_F(NodeSystemTest, MovesOntoShiftedPlanesWhateverAFewFarOnesSay) {
  const Vector3 shift(0.02, 0.01, -0.03);
  std::vector<PlanePair> planes;
  const Points normals = vertex_normals(sphere_);
  const double area = vertex_areas(sphere_).sum() / static_cast<double>(sphere_.vertices.cols());
  for (int i = 0; i < sphere_.vertices.cols(); ++i)
    planes.push_back({i, sphere_.vertices.col(i) + shift, normals.col(i), area});
  for (int i = 0; i < 50; ++i) planes[static_cast<std::size_t>(10 * i)].point += Vector3(5, 0, 0);
  const Points moved = solve(system({}), planes);
  EXPECT_LT((moved.colwise() - shift - sphere_.vertices).colwise().norm().maxCoeff(), 0.1 * shift.norm());
}

TEST_F(NodeSystemTest, CountsFarPlanesWithAScaleGain) {
  const Points normals = vertex_normals(sphere_);
  const double area = vertex_areas(sphere_).sum() / static_cast<double>(sphere_.vertices.cols());
  const auto reached = [&](double outlier_scale_gain) {
    std::vector<PlanePair> planes;
    for (int i = 0; i < sphere_.vertices.cols(); ++i) {
      const bool far = normals(2, i) > 0.9;
      planes.push_back({i, sphere_.vertices.col(i) + (far ? 0.5 : 0.001) * normals.col(i), normals.col(i),
                        area, outlier_scale_gain});
    }
    const double smoothing = 0.06;
    return (solve(system({}), planes, smoothing).row(2).maxCoeff() - 1) / 0.5;
  };
  EXPECT_LT(reached(0), 0.1);
  EXPECT_GT(reached(1), 0.5);
}

TEST_F(NodeSystemTest, KnowsWhereAnAnchorWouldBeWithoutIt) {
  std::vector<PlanePair> planes;
  const Points normals = vertex_normals(sphere_);
  for (int i = 0; i < sphere_.vertices.cols(); ++i)
    planes.push_back({i, 1.1 * sphere_.vertices.col(i), normals.col(i), 1e-3});
  const std::vector<NodeAnchor> anchors{anchor(0, Vector3(0.2, 0, 0)), anchor(40, Vector3(0, 0.3, 0)),
                                        anchor(90, Vector3::Zero()), anchor(7, Vector3(0, 0, -0.1))};
  const NodeGoals all{sphere_.vertices, planes, {}, 1, 1};
  NodeSystem with(system(anchors));
  with.solve(all);
  const LeftOutAnchors left_out = with.left_out();
  for (std::size_t k = 0; k < anchors.size(); ++k) {
    NodeGoals others = all;
    others.anchor_inliers.assign(anchors.size(), 1);
    others.anchor_inliers[k] = 0;
    const Points moved = system(anchors).solve(others);
    const Vector3 goal = anchors[k].foot.point + anchors[k].displacement;
    EXPECT_NEAR(left_out.distances[static_cast<Eigen::Index>(k)],
                (carried(anchors[k].foot, sphere_.faces, moved) - goal).norm(), 1e-6);
    EXPECT_GT(left_out.compliances[static_cast<Eigen::Index>(k)], 0);
  }
}

TEST_F(NodeSystemTest, BendsLessTheMoreItSmooths) {
  const std::vector<NodeAnchor> anchors{anchor(0, Vector3(0.2, 0, 0)), anchor(1, Vector3::Zero()),
                                        anchor(2, Vector3::Zero()), anchor(3, Vector3::Zero())};
  double last = 0;
  for (const double smoothing : {3.0, 1.0, 0.3}) {
    const Points moved = solve(system(anchors), {}, smoothing);
    const double reached = (moved.col(0) - sphere_.vertices.col(0)).x();
    EXPECT_GT(reached, last);
    last = reached;
  }
  EXPECT_LE(last, 0.2 + 1e-9);
}

TEST_F(NodeSystemTest, BendsByTheAreasThatItHasNow) {
  // One pole has grown, the other shrunk; a dent is pressed into either.
  const Points normals = vertex_normals(sphere_);
  const Eigen::RowVectorXd growth = 1 + 0.4 * sphere_.vertices.row(2).array();
  const Points lying = sphere_.vertices * growth.transpose().asDiagonal();
  const double area = vertex_areas(sphere_).sum() / static_cast<double>(sphere_.vertices.cols());
  const auto pressed = [&](double depth) {
    constexpr double smoothing = 0.5, outlier_scale_gain = 1;
    std::vector<PlanePair> planes;
    for (int i = 0; i < lying.cols(); ++i) {
      const double press = std::abs(normals(2, i)) > 0.97 ? depth : 0;
      planes.push_back({i, lying.col(i) - press * normals.col(i), normals.col(i), area, outlier_scale_gain});
    }
    NodeSystem nodes = system({});
    nodes.start_from(lying);
    return nodes.solve({lying, planes, {}, smoothing, 1});
  };
  struct Dents {
    double grown, shrunk;
  };
  const auto dents = [&](double max_growth) -> Dents {
    settings_.bending.max_growth = max_growth;
    const Eigen::RowVectorXd sunk = (pressed(0) - pressed(0.1)).row(2);
    return {sunk.maxCoeff(), -sunk.minCoeff()};
  };
  const Dents now = dents(10), at_rest = dents(1);
  EXPECT_LT(now.grown, 0.95 * at_rest.grown);
  EXPECT_GT(now.shrunk, 1.05 * at_rest.shrunk);
}

TEST_F(NodeSystemTest, ASimilarityIsNextToNoStrainAndAStretchAlongOneAxisIs) {
  NodeSystem nodes = system({});
  EXPECT_NEAR(nodes.median_strain(), 0, 1e-12);
  const auto strain = [&](const Matrix3& change) {
    nodes.start_from((change * sphere_.vertices).colwise() + Vector3(4, 5, 6));
    return nodes.median_strain();
  };
  const Matrix3 turn = Eigen::AngleAxisd(0.1, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  double last = 3 * strain(1.1 * turn);
  for (const double factor : {1.1, 1.3, 1.7}) {
    const double stretched = strain(Vector3(factor, 1, 1).asDiagonal());
    EXPECT_GT(stretched, last) << factor;
    last = stretched;
  }
}

TEST_F(NodeSystemTest, StrainsLessTheMoreRigidItIs) {
  const std::vector<NodeAnchor> anchors{anchor(0, Vector3(0.3, 0, 0)), anchor(1, Vector3::Zero()),
                                        anchor(2, Vector3(0, 0.2, 0)), anchor(3, Vector3::Zero())};
  double last = std::numeric_limits<double>::infinity();
  for (const double rigidity : {1.0, 3.0, 10.0}) {
    NodeSystem nodes = system(anchors);
    for (int iteration = 0; iteration < 5; ++iteration)
      nodes.solve({sphere_.vertices, {}, {}, 1, 1, {}, rigidity});
    EXPECT_LT(nodes.median_strain(), last) << rigidity;
    last = nodes.median_strain();
  }
}

TEST_F(NodeSystemTest, KeepsTheShapeNotThePoseThatItStartsFrom) {
  // Two copies of a squeezed sphere: nothing pulls, and the one that knows its shape goes back to it.
  TriangleMesh squeezed = sphere_;
  squeezed.vertices.row(0) *= 0.8;
  const auto extent_after = [&](const Points& shape) {
    NodeSystem nodes({squeezed, shape, vertex_areas(squeezed).sum()}, make_deformation_nodes(squeezed, 0.3),
                     {}, settings_);
    Points moved;
    for (int iteration = 0; iteration < 50; ++iteration)
      moved = nodes.solve({squeezed.vertices, {}, {}, 0.1, 1, {}, 10});
    return moved.row(0).maxCoeff() - moved.row(0).minCoeff();
  };
  EXPECT_NEAR(extent_after(squeezed.vertices), 1.6, 0.01);
  EXPECT_GT(extent_after(sphere_.vertices), 1.8);
}

}  // namespace
}  // namespace bespoke
