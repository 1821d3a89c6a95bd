#include "bespoke/rigid/similarity_alignment.h"

#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "support/random_points.h"

namespace bespoke {
namespace {

TEST(AlignSimilarly, RecoversASimilarityExactly) {
  const Points x = test::random_points(20, 1);
  const Similarity truth{1.7, test::random_rotation(2), Vector3(3, -4, 5)};
  const Similarity found = align_similarly(x, truth * x, Eigen::VectorXd::Ones(20));
  EXPECT_NEAR(found.scale, truth.scale, 1e-12);
  EXPECT_LT((found.rotation - truth.rotation).norm(), 1e-12);
  EXPECT_LT((found.translation - truth.translation).norm(), 1e-12);
  EXPECT_THROW(align_similarly(Points::Zero(3, 5), x.leftCols(5), Eigen::VectorXd::Ones(5)), InvalidInput);
}

TEST(AlignSimilarly, NeverMirrors) {
  Points x = test::random_points(20, 1), mirrored = x;
  mirrored.row(0) *= -1;
  EXPECT_NEAR(align_similarly(x, mirrored, Eigen::VectorXd::Ones(20)).rotation.determinant(), 1, 1e-12);
}

}  // namespace
}  // namespace bespoke
