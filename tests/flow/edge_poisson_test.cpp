#include "bespoke/flow/detail/edge_poisson.h"

#include <gtest/gtest.h>

#include <numeric>

#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

TEST(EdgePoisson, MeetsGradientsOfADeformationExactly) {
  const TriangleMesh source = shapes::joined(shapes::icosphere(2), shapes::cube());
  const Points fitted = source.vertices + 0.5 * test::random_points(source.vertices.cols(), 2);
  const FaceGradients gradients = face_gradients(source, fitted);
  FaceRotations rotations(source, gradients);
  std::vector<int> faces(static_cast<std::size_t>(source.faces.cols()));
  std::iota(faces.begin(), faces.end(), 0);
  rotations.spread(faces, Vector3::Zero());
  const int cube = static_cast<int>(source.vertices.cols()) - 8;
  const Points solution = EdgePoisson(source, gradients.areas, {0, cube}).solve(rotations, 1);
  for (Eigen::Index i = 0; i < solution.cols(); ++i) {
    const Vector3 expected = fitted.col(i) - fitted.col(i < cube ? 0 : cube);
    EXPECT_LT((solution.col(i) - expected).norm(), 1e-10) << i;
  }
}

}  // namespace
}  // namespace bespoke
