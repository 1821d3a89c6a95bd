#include "bespoke/elastic/pffd.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "bespoke/bake/bake.h"
#include "bespoke/certificate/certificate.h"
#include "bespoke/error.h"
#include "bespoke/lattice/baked_map.h"
#include "bespoke/mesh/closest_point.h"
#include "support/finite_differences.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

constexpr double width = 0.4;
const TriangleMesh sphere = shapes::icosphere(2);

Points sheared_bend(const Points& x) {
  Points result = x;
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    result.col(i) += Vector3(0.2 * x(2, i), 0.1 * x(0, i) * x(0, i), 0.2 * x(2, i) * x(1, i));
  return result;
}

/// Points up to λ from the sphere.
Points near_points(Eigen::Index count, unsigned seed) {
  Points x = test::random_points(count, seed).colwise().normalized();
  const Points height = test::random_points(count, seed + 1);
  for (Eigen::Index i = 0; i < count; ++i) x.col(i) *= 1 + 0.9 * width * height(0, i);
  return x;
}

/// The frame of a triangle: corner, edges, and the unit normal times the square root of twice the area.
struct Frame {
  Vector3 corner;
  Matrix3 axes;
};

Frame frame_of(const TriangleMesh& mesh, const Points& vertices, Eigen::Index face) {
  const Vector3 a = vertices.col(mesh.faces(0, face));
  const Vector3 ab = vertices.col(mesh.faces(1, face)) - a;
  const Vector3 ac = vertices.col(mesh.faces(2, face)) - a;
  const Vector3 normal = ab.cross(ac);
  Matrix3 axes;
  axes << ab, ac, normal / std::sqrt(normal.norm());
  return {a, axes};
}

/// Eq. 18 written down again: over all faces, with no search structure.
Vector3 printed(const TriangleMesh& mesh, const Points& fitted, const Vector3& x) {
  std::vector<double> distance;
  double nearest = 1e300;
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    Vector3 centre = Vector3::Zero();
    for (const int vertex : mesh.faces.col(face)) centre += mesh.vertices.col(vertex) / 3;
    distance.push_back((x - centre).norm());
    nearest = std::min(nearest, distance.back());
  }
  Vector3 sum = Vector3::Zero();
  double total = 0;
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    const double d = distance[static_cast<std::size_t>(face)];
    if (!(d < 1.5 * nearest)) continue;
    const Frame from = frame_of(mesh, mesh.vertices, face), to = frame_of(mesh, fitted, face);
    const double weight = 1 / (1e-8 + d * d * d);
    sum += weight * (to.corner + to.axes * (from.axes.inverse() * (x - from.corner)));
    total += weight;
  }
  return sum / total;
}

TEST(PffdMap, IsThePrintedMeanOfNearFaces) {
  const Points fitted = sheared_bend(sphere.vertices);
  const PffdMap map(sphere, fitted, width);
  const Points x = near_points(300, 1);
  const Points image = map(x);
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    EXPECT_LT((image.col(i) - printed(sphere, fitted, x.col(i))).norm(), 1e-12) << x.col(i).transpose();
}

TEST(PffdMap, ReproducesSimilaritiesEverywhere) {
  const AffineMap similarity{1.7 * test::random_rotation(3), Vector3(1, 2, 3)};
  const PffdMap map(sphere, similarity * sphere.vertices, width);
  const Points x = 2 * test::random_points(300, 4);
  EXPECT_LT((map(x) - similarity * x).cwiseAbs().maxCoeff(), 1e-11);
}

TEST(PffdMap, IsAffineBeyondLambdaAndJumpsThere) {
  const PffdMap map(sphere, sheared_bend(sphere.vertices), width);
  const ClosestPointTree surface(sphere);
  const Points x = 1.6 * test::random_points(2000, 5);
  const Points u = map.displacement(x);
  double largest_at_rim = 0;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const double distance = std::sqrt(surface.closest(x.col(i))->squared_distance);
    if (distance > width * (1 + 1e-9)) {
      EXPECT_EQ(u.col(i), Vector3(Vector3::Zero()));
    } else if (distance > 0.99 * width) {
      largest_at_rim = std::max(largest_at_rim, u.col(i).norm());
    }
  }
  // The printed form has no rim; cut off, it ends in a jump.
  EXPECT_GT(largest_at_rim, 0.01);
}

TEST(PffdMap, GradientIsTheLimitOfDifferencesBetweenJumps) {
  const PffdMap map(sphere, sheared_bend(sphere.vertices), width);
  const Points x = near_points(100, 6);
  const Points gradient = map.displacement_gradient(x);
  constexpr double step = 1e-6;
  int between_jumps = 0;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    Points around(3, 6);
    for (int axis = 0; axis < 3; ++axis) {
      around.col(2 * axis) = x.col(i) + step * Vector3::Unit(axis);
      around.col(2 * axis + 1) = x.col(i) - step * Vector3::Unit(axis);
    }
    const Points u = map.displacement(around);
    Matrix3 differences;
    for (int axis = 0; axis < 3; ++axis)
      differences.col(axis) = (u.col(2 * axis) - u.col(2 * axis + 1)) / (2 * step);
    // A jump between the six points shows as a gradient of its size over the step.
    if (differences.norm() > 1e3) continue;
    ++between_jumps;
    EXPECT_LT((differences - gradient.middleCols<3>(3 * i)).norm(), 1e-4 * (1 + differences.norm()));
  }
  EXPECT_GT(between_jumps, 90);
}

TEST(PffdMap, BakesAsItIsAndTheCertificateCounts) {
  const PffdMap map(sphere, sheared_bend(sphere.vertices), width);
  BakeOptions options;
  options.tolerance = 0.02;
  options.error_points = 20'000;
  const Bake baked = bake(map, options);
  // Jumps are met by no voxel: the bake stops at its finest ones and says so.
  EXPECT_FALSE(baked.summary.tolerance_met);
  EXPECT_GE(baked.pyramid.levels.back().voxel_size, options.tolerance / 2);
  const Certificate certificate = certify(baked.pyramid, map.affine());
  EXPECT_GT(certificate.certified, 0u);
  EXPECT_EQ(certificate.folded + certificate.undecided, baked.summary.folded_cells);
  const Points vertices = BakedMap(map.affine(), baked.pyramid)(sphere.vertices);
  EXPECT_LT((vertices - map(sphere.vertices)).colwise().norm().maxCoeff(), 0.1);
}

TEST(PffdMap, BakesToOneLatticeWhoseFoldsAreCounted) {
  const PffdMap map(sphere, sheared_bend(sphere.vertices), width);
  BakeOptions options;
  options.tolerance = 0.02;
  options.error_points = 1'000;
  options.voxel_size = 0.1;
  const Bake baked = bake(map, options);
  const Certificate certificate = certify(baked.pyramid, map.affine());
  ASSERT_GT(certificate.folded, 0u);
  EXPECT_EQ(baked.summary.folded_cells, certificate.folded + certificate.undecided);
}

TEST(PffdMap, RejectsWhatItCannotUse) {
  const TriangleMesh triangle = shapes::triangle();
  EXPECT_THROW(PffdMap(triangle, triangle.vertices.leftCols(2), 1), InvalidInput);
  EXPECT_THROW(PffdMap(triangle, triangle.vertices, 0), InvalidInput);
  EXPECT_THROW(PffdMap(triangle, triangle.vertices * std::nan(""), 1), InvalidInput);
  EXPECT_NO_THROW(PffdMap(triangle, triangle.vertices, 1));
}

}  // namespace
}  // namespace bespoke
