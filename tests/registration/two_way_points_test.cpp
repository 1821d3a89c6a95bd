#include "bespoke/registration/detail/two_way_points.h"

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace bespoke {
namespace {

std::vector<int> all_vertices(const TriangleMesh& mesh) {
  std::vector<int> vertices;
  for (int i = 0; i < mesh.vertices.cols(); ++i) vertices.push_back(i);
  return vertices;
}

Points turned(const Points& x, double angle) {
  return Eigen::AngleAxisd(angle, Vector3::UnitZ()).toRotationMatrix() * x;
}

TEST(TwoWayPoints, AgreeWhereEachWayIsTheOthersInverse) {
  const TriangleMesh source = shapes::icosphere(3), target{2 * source.vertices, source.faces};
  const TwoWayPoints points =
      two_way_points(source, target.vertices, target, source.vertices, all_vertices(source));
  EXPECT_LT(points.apart.maxCoeff(), 1e-12);
  EXPECT_LT((points.middles - target.vertices).cwiseAbs().maxCoeff(), 1e-12);
}

// One way turns by 0.1, the other, back, by nothing: a point at distance r from the axis is 0.1 r apart.
TEST(TwoWayPoints, AreApartByWhatTheWaysDifferIn) {
  const TriangleMesh sphere = shapes::icosphere(4);
  const TwoWayPoints points =
      two_way_points(sphere, turned(sphere.vertices, 0.1), sphere, sphere.vertices, all_vertices(sphere));
  const Eigen::VectorXd chords = 2 * std::sin(0.05) * sphere.vertices.topRows<2>().colwise().norm();
  EXPECT_LT((points.apart - chords).cwiseAbs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace bespoke
