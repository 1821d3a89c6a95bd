#include "bespoke/quality/distortion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "bespoke/error.h"
#include "support/analytic_map.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

/// u(x) = M x in the unit ball: not continuous, but its Jacobian is the same everywhere in the band.
class LinearInBall : public ElasticMap {
 public:
  explicit LinearInBall(const Matrix3& gradient, const Matrix3& linear = Matrix3::Identity())
      : gradient_(gradient), linear_(linear) {}
  AffineMap affine() const override { return {linear_, {1, 2, 3}}; }
  Points displacement(const Points& x) const override {
    Points u = gradient_ * x;
    for (Eigen::Index i = 0; i < x.cols(); ++i)
      if (x.col(i).norm() > 1) u.col(i).setZero();
    return u;
  }
  Points displacement_gradient(const Points& x) const override {
    Points gradient = Points::Zero(3, 3 * x.cols());
    for (Eigen::Index i = 0; i < x.cols(); ++i)
      if (x.col(i).norm() <= 1) gradient.middleCols<3>(3 * i) = gradient_;
    return gradient;
  }
  Support support() const override { return {{}, {{Points::Zero(3, 1), 1}}}; }

 private:
  Matrix3 gradient_, linear_;
};

Matrix3 diagonal_matrix(double x, double y, double z) { return Vector3(x, y, z).asDiagonal(); }

TEST(Spread, IsOfValuesOfTheSample) {
  std::vector<double> values;
  for (int i = 100; i >= 1; --i) values.push_back(i);
  const Spread found = spread(values);
  EXPECT_EQ(found.count, 100u);
  EXPECT_EQ(found.min, 1);
  EXPECT_EQ(found.p1, 1);
  EXPECT_EQ(found.median, 50);
  EXPECT_EQ(found.p99, 99);
  EXPECT_EQ(found.max, 100);
  EXPECT_EQ(spread({}).count, 0u);
  EXPECT_THROW(spread({std::nan("")}), InvalidInput);
}

TEST(MapDistortion, IsThatOfTheSingularValues) {
  // A + ∇u = diag(3, 2, 0.5) up to a rotation.
  const Matrix3 rotation = Eigen::AngleAxisd(0.7, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  const Matrix3 linear = diagonal_matrix(1, 1, 1);
  const LinearInBall map(rotation * diagonal_matrix(3, 2, 0.5) * rotation.transpose() - linear, linear);
  const MapDistortion distortion = map_distortion(map, {.samples = 5000});
  EXPECT_GT(distortion.samples, 1000u);
  for (const double value : {distortion.conformal.min, distortion.conformal.p1, distortion.conformal.median,
                             distortion.conformal.max})
    EXPECT_NEAR(value, 6, 1e-12);
  EXPECT_NEAR(distortion.area.p1, 6, 1e-12);
  EXPECT_NEAR(distortion.area.p99, 6, 1e-12);
  EXPECT_NEAR(distortion.volume.median, 3, 1e-12);
  EXPECT_NEAR(distortion.min_determinant, 3, 1e-12);
  EXPECT_EQ(distortion.flips, 0u);
}

TEST(MapDistortion, OfAnAffineMapIsThatOfItsLinearPart) {
  const LinearInBall affine(Matrix3::Zero(), diagonal_matrix(3, 2, 0.5));
  const MapDistortion distortion = map_distortion(affine, {.samples = 5000});
  EXPECT_EQ(distortion.samples, 0u);
  EXPECT_EQ(distortion.flips, 0u);
  for (const Spread& spread : {distortion.conformal, distortion.area}) {
    EXPECT_EQ(spread.count, 1u);
    EXPECT_NEAR(spread.min, 6, 1e-12);
    EXPECT_NEAR(spread.max, 6, 1e-12);
  }
  EXPECT_NEAR(distortion.volume.median, 3, 1e-12);
  EXPECT_NEAR(distortion.min_determinant, 3, 1e-12);
}

TEST(MapDistortion, SeesWhatIsTurnedInsideOut) {
  const MapDistortion distortion = map_distortion(LinearInBall(diagonal_matrix(-2, 0, 0)), {.samples = 5000});
  EXPECT_EQ(distortion.flips, distortion.samples);
  EXPECT_NEAR(distortion.min_determinant, -1, 1e-15);
  EXPECT_NEAR(distortion.conformal.max, 1, 1e-15);
}

TEST(MapDistortion, OfACollapseIsFlippedAndHasNoConformalValue) {
  const MapDistortion distortion = map_distortion(LinearInBall(diagonal_matrix(-1, 0, 0)), {.samples = 5000});
  EXPECT_EQ(distortion.flips, distortion.samples);
  EXPECT_EQ(distortion.conformal.count, 0u);
}

TEST(MapDistortion, CoversTheBandEvenly) {
  // det = 1 + ∂u/∂x of a bump along x; its least value is known by its profile (1 − s²)⁴ in closed form:
  // the derivative −8 s (1 − s²)³ is extreme at s² = 1/7.
  const double radius = 2, amplitude = 0.5, s = std::sqrt(1.0 / 7);
  const AnalyticMap map({{{0.3, -0.2, 0.1}, radius, {amplitude, 0, 0}}});
  const MapDistortion distortion = map_distortion(map);
  const double steepest = 8 * s * std::pow(1 - s * s, 3) * amplitude / radius;
  EXPECT_NEAR(distortion.min_determinant, 1 - steepest, 3e-3);
  EXPECT_GE(distortion.min_determinant, 1 - steepest);
  EXPECT_NEAR(distortion.volume.max, 1 + steepest, 3e-3);
  EXPECT_NEAR(distortion.volume.median, 1, 1e-3);  // as much is pressed together as is pulled apart
  EXPECT_GT(distortion.samples, 50000u);
}

TEST(MapDistortion, OfAnAffineMapHasNoSamples) {
  const AnalyticMap map({}, {diagonal_matrix(2, 3, 4), Vector3::Zero()});
  const MapDistortion distortion = map_distortion(map);
  EXPECT_EQ(distortion.samples, 0u);
  EXPECT_EQ(distortion.min_determinant, 24);
  EXPECT_THROW(map_distortion(map, {.samples = 0}), InvalidInput);
}

TEST(MapDistortion, StopsWhenAsked) {
  const Progress progress{.report = {}, .cancelled = [] { return true; }};
  EXPECT_THROW(map_distortion(LinearInBall(diagonal_matrix(1, 0, 0)), {}, progress), Interrupted);
}

TEST(FlippedFaces, AreNoneUnderADiffeomorphismAndAllUnderAReflection) {
  const TriangleMesh sphere =
      shapes::moved(shapes::icosphere(2), {0.5 * Matrix3::Identity(), Vector3::Zero()});
  const LinearInBall stretch(diagonal_matrix(1, 2, -0.5)), reflection(diagonal_matrix(-2, 0, 0));
  EXPECT_EQ(flipped_faces(sphere, stretch(sphere.vertices), stretch), 0u);
  EXPECT_EQ(flipped_faces(sphere, reflection(sphere.vertices), reflection), 320u);
  EXPECT_THROW(flipped_faces(sphere, Points(3, 2), stretch), InvalidInput);
}

TEST(FlippedFaces, AreThoseThatAVertexWasPulledAcross) {
  const TriangleMesh square = shapes::square_grid(2);
  const AnalyticMap identity({});
  Points mapped = square.vertices;
  mapped.col(0) = Vector3(0.9, 0.8, 0);  // across the diagonal of its square, into the next ones
  EXPECT_EQ(flipped_faces(square, mapped, identity), 2u);
}

TEST(MeshDistortion, OfASimilarityIsItsFactorAndNoAngle) {
  const TriangleMesh sphere = shapes::icosphere(2);
  const Matrix3 rotation = Eigen::AngleAxisd(1, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  const MeshDistortion distortion =
      mesh_distortion(sphere, AffineMap{3 * rotation, {1, 1, 1}} * sphere.vertices);
  EXPECT_EQ(distortion.edge_length.count, 480u);
  EXPECT_NEAR(distortion.edge_length.min, 3, 1e-13);
  EXPECT_NEAR(distortion.edge_length.max, 3, 1e-13);
  EXPECT_EQ(distortion.angle.count, 960u);
  EXPECT_LT(distortion.angle.max, 1e-11);
}

TEST(MeshDistortion, OfAKnownTriangle) {
  // Legs 1 and 1 become 1 and √3: angles 90, 45, 45 become 90, 60, 30 degrees.
  const TriangleMesh triangle = shapes::triangle();
  Points after = triangle.vertices;
  after(1, 2) = std::sqrt(3);
  const MeshDistortion distortion = mesh_distortion(triangle, after);
  EXPECT_EQ(distortion.edge_length.min, 1);
  EXPECT_DOUBLE_EQ(distortion.edge_length.median, std::sqrt(2));
  EXPECT_DOUBLE_EQ(distortion.edge_length.max, std::sqrt(3));
  EXPECT_NEAR(distortion.angle.min, 0, 1e-12);
  EXPECT_NEAR(distortion.angle.median, 15, 1e-12);
  EXPECT_NEAR(distortion.angle.max, 15, 1e-12);
}

TEST(MeshDistortion, CountsWhatItLeavesOut) {
  TriangleMesh mesh = shapes::triangle();
  mesh.vertices.col(1) = mesh.vertices.col(0);
  const MeshDistortion distortion = mesh_distortion(mesh, shapes::triangle().vertices);
  EXPECT_EQ(distortion.left_out_edges, 1u);
  EXPECT_EQ(distortion.left_out_faces, 1u);
  EXPECT_EQ(distortion.edge_length.count, 2u);
  EXPECT_THROW(mesh_distortion(mesh, Points(3, 2)), InvalidInput);
}

}  // namespace
}  // namespace bespoke
