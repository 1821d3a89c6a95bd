#include "bespoke/rigid/rigid_transform.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "bespoke/error.h"
#include "support/random_points.h"

namespace bespoke {
namespace {

double angle_between(const Matrix3& a, const Matrix3& b) {
  return Eigen::Quaterniond(a).angularDistance(Eigen::Quaterniond(b));
}

void expect_motion(const Matrix3& rotation) {
  EXPECT_LT((rotation.transpose() * rotation - Matrix3::Identity()).norm(), 1e-13);
  EXPECT_GT(rotation.determinant(), 0);
}

TEST(Inverse, UndoesTheTransformFromBothSides) {
  const RigidTransform transform{test::random_rotation(1), Vector3(3, -4, 5)};
  for (const RigidTransform& identity : {inverse(transform) * transform, transform * inverse(transform)}) {
    EXPECT_LT((identity.rotation - Matrix3::Identity()).norm(), 1e-14);
    EXPECT_LT(identity.translation.norm(), 1e-14);
  }
}

TEST(RigidTransform, ComposesLikeTheFunctions) {
  const RigidTransform a{test::random_rotation(2), Vector3(1, 2, 3)};
  const RigidTransform b{test::random_rotation(3), Vector3(-2, 0, 1)};
  const Points x = test::random_points(10, 4);
  EXPECT_LT(((a * b) * x - a * (b * x)).norm(), 1e-13);
}

TEST(RotationAt, IsIdentityAtZeroAndTheRotationAtOneExactly) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Matrix3 rotation = test::random_rotation(seed);
    for (const RotationPath path : {RotationPath::geodesic, RotationPath::euler}) {
      EXPECT_EQ(rotation_at(rotation, path, 0), Matrix3::Identity());
      EXPECT_EQ(rotation_at(rotation, path, 1), rotation);
    }
  }
}

TEST(RotationAt, ReachesItsEndsContinuously) {
  constexpr double small = 1e-9;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Matrix3 rotation = test::random_rotation(seed);
    for (const RotationPath path : {RotationPath::geodesic, RotationPath::euler}) {
      EXPECT_LT((rotation_at(rotation, path, small) - Matrix3::Identity()).norm(), 1e-7);
      EXPECT_LT((rotation_at(rotation, path, 1 - small) - rotation).norm(), 1e-7);
      expect_motion(rotation_at(rotation, path, 0.3));
    }
  }
}

TEST(RotationAt, GeodesicHasConstantAngularSpeed) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Matrix3 rotation = test::random_rotation(seed);
    const double whole = angle_between(Matrix3::Identity(), rotation);
    for (double t = 0; t < 0.95; t += 0.1) {
      const double step = angle_between(rotation_at(rotation, RotationPath::geodesic, t),
                                        rotation_at(rotation, RotationPath::geodesic, t + 0.1));
      EXPECT_NEAR(step, whole / 10, 1e-12);
    }
  }
}

TEST(RotationAt, EulerHasNotConstantAngularSpeedForSeveralAxes) {
  const Matrix3 rotation =
      (Eigen::AngleAxisd(1.2, Vector3::UnitZ()) * Eigen::AngleAxisd(0.9, Vector3::UnitY()) *
       Eigen::AngleAxisd(-1, Vector3::UnitX()))
          .toRotationMatrix();
  const double first = angle_between(Matrix3::Identity(), rotation_at(rotation, RotationPath::euler, 0.1));
  const double last = angle_between(rotation_at(rotation, RotationPath::euler, 0.9), rotation);
  EXPECT_GT(std::abs(first - last), 0.01 * first);
}

TEST(RotationAt, EulerScalesTheThreeAngles) {
  const auto rotation = [](double t) -> Matrix3 {
    return (Eigen::AngleAxisd(0.7 * t, Vector3::UnitZ()) * Eigen::AngleAxisd(-0.4 * t, Vector3::UnitY()) *
            Eigen::AngleAxisd(1.1 * t, Vector3::UnitX()))
        .toRotationMatrix();
  };
  for (const double t : {-0.5, 0.25, 0.5, 0.75, 1.5})
    EXPECT_LT((rotation_at(rotation(1), RotationPath::euler, t) - rotation(t)).norm(), 1e-14);
}

TEST(RotationAt, PathsAgreeForASingleAxis) {
  const Matrix3 rotation = Eigen::AngleAxisd(2, Vector3::UnitY() * -1).toRotationMatrix();
  // Beyond a quarter turn about y the Euler angles are a different triple, so stay below it.
  const Matrix3 about_z = Eigen::AngleAxisd(2, Vector3::UnitZ()).toRotationMatrix();
  EXPECT_LT(
      (rotation_at(about_z, RotationPath::euler, 0.4) - rotation_at(about_z, RotationPath::geodesic, 0.4))
          .norm(),
      1e-14);
  expect_motion(rotation_at(rotation, RotationPath::euler, 0.4));
}

TEST(RotationAt, IsRobustNearHalfATurn) {
  const double pi = std::numbers::pi;
  for (const double below : {0.0, 1e-15, 1e-12, 1e-8, 1e-4}) {
    for (unsigned seed = 0; seed < 20; ++seed) {
      const Vector3 axis = test::random_points(1, seed).col(0).normalized();
      const Matrix3 rotation = Eigen::AngleAxisd(pi - below, axis).toRotationMatrix();
      const Matrix3 half = rotation_at(rotation, RotationPath::geodesic, 0.5);
      expect_motion(half);
      EXPECT_LT((half * half - rotation).norm(), 1e-13) << "angle pi - " << below;
      EXPECT_LT((half * axis - axis).norm(), 1e-13);
    }
  }
}

TEST(RotationAt, IsRobustNearTheIdentity) {
  for (const double angle : {0.0, 1e-300, 1e-18, 1e-12, 1e-8}) {
    const Matrix3 rotation = Eigen::AngleAxisd(angle, Vector3(1, 2, 2) / 3).toRotationMatrix();
    for (const RotationPath path : {RotationPath::geodesic, RotationPath::euler}) {
      const Matrix3 half = rotation_at(rotation, path, 0.5);
      EXPECT_LT((half * half - rotation).norm(), 1e-15);
    }
  }
}

TEST(RotationAt, KeepsASmallAngle) {
  const Matrix3 rotation = Eigen::AngleAxisd(1e-7, Vector3::UnitX()).toRotationMatrix();
  EXPECT_NEAR(rotation_at(rotation, RotationPath::geodesic, 0.5)(2, 1), 0.5e-7, 1e-20);
}

TEST(RotationAt, IsRobustAtGimbalLock) {
  for (const double sign : {-1.0, 1.0}) {
    const Matrix3 rotation = (Eigen::AngleAxisd(0.3, Vector3::UnitZ()) *
                              Eigen::AngleAxisd(sign * std::numbers::pi / 2, Vector3::UnitY()) *
                              Eigen::AngleAxisd(0.5, Vector3::UnitX()))
                                 .toRotationMatrix();
    expect_motion(rotation_at(rotation, RotationPath::euler, 0.5));
    EXPECT_LT((rotation_at(rotation, RotationPath::euler, 1 - 1e-9) - rotation).norm(), 1e-7);
  }
}

TEST(RotationAt, RefusesATimeThatIsNotFinite) {
  EXPECT_THROW(
      rotation_at(Matrix3::Identity(), RotationPath::geodesic, std::numeric_limits<double>::quiet_NaN()),
      InvalidInput);
}

}  // namespace
}  // namespace bespoke
