#include "bespoke/exchange/displacement_image.h"

#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "support/random_points.h"

namespace bespoke {
namespace {

constexpr std::size_t plenty = std::size_t{1} << 30;

const Box box{Vector3(-1, -2, 0.5), Vector3(1, 1, 2)};

Points wave(const Points& x) {
  Points y = x;
  for (Eigen::Index i = 0; i < x.cols(); ++i) y(1, i) += 0.1 * std::sin(2 * x(0, i)) * std::cos(x(2, i));
  return y;
}

TEST(DisplacementImage, CoversItsBoxByNodes) {
  const DisplacementImage image = sample_displacements(&wave, box, 0.3, plenty);
  EXPECT_EQ(image.values.size(), 3 * image.size[0] * image.size[1] * image.size[2]);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    const double end = image.origin(a) + image.spacing * double(image.size[axis] - 1);
    EXPECT_EQ(image.origin(a), box.min()(a));
    EXPECT_GE(end, box.max()(a) - 1e-12);
    EXPECT_LT(end, box.max()(a) + image.spacing);
  }
}

TEST(DisplacementImage, IsExactForAffineMaps) {
  const PointFunction affine = [](const Points& x) {
    Matrix3 a;
    a << 1.1, 0.2, 0, -0.1, 0.9, 0.3, 0, 0.1, 1.2;
    return Points((a * x).colwise() + Vector3(3, -2, 1));
  };
  const DisplacementImage image = sample_displacements(affine, box, 0.4, plenty);
  EXPECT_LT(sampling_error(image, affine, box, 5000).max, 1e-6);
}

TEST(DisplacementImage, MissesASmoothMapByTheSquareOfItsSpacing) {
  const double coarse = sampling_error(sample_displacements(&wave, box, 0.2, plenty), &wave, box, 20000).p99;
  const double fine = sampling_error(sample_displacements(&wave, box, 0.1, plenty), &wave, box, 20000).p99;
  EXPECT_NEAR(coarse / fine, 4, 0.4);
}

TEST(DisplacementImage, FindsALargeErrorInASmallPlace) {
  const Vector3 middle = box.center();
  const PointFunction bump = [&](const Points& x) {
    Points moved = x;
    for (auto&& each : moved.colwise()) each.z() += 0.1 * std::exp(-(each - middle).squaredNorm() / 0.02);
    return moved;
  };
  const DisplacementImage image = sample_displacements(bump, box, 0.2, plenty);
  double largest = 0;
  for (int i = 0; i < 8000; ++i) {
    const Vector3 x = middle + 0.1 * (Vector3(i % 20, i / 20 % 20, i / 400) / 9.5 - Vector3::Ones());
    largest = std::max(largest, (x + image(x) - bump(x)).norm());
  }
  ASSERT_GT(largest, 0.01);
  const Statistics error = sampling_error(image, bump, box, 5000);
  EXPECT_LT(error.p95, 0.01 * largest);
  EXPECT_GT(error.max, 0.9 * largest);
}

TEST(DisplacementImage, HoldsTheDisplacementAtItsNodes) {
  const DisplacementImage image = sample_displacements(&wave, box, 0.25, plenty);
  Points nodes(3, 4);
  nodes << 0, 1, 2, 7, 0, 3, 1, 11, 0, 2, 5, 4;
  const Points x = (image.spacing * nodes).colwise() + image.origin;
  EXPECT_LT((image(x) - (wave(x) - x)).cwiseAbs().maxCoeff(), 1e-7);
}

TEST(DisplacementImage, RefusesGridsThatNobodyCanHold) {
  EXPECT_THROW(sample_displacements(&wave, box, 0, plenty), InvalidInput);
  EXPECT_THROW(sample_displacements(&wave, box, -1, plenty), InvalidInput);
  EXPECT_THROW(sample_displacements(&wave, Box(), 0.1, plenty), InvalidInput);
  try {
    sample_displacements(&wave, box, 0.01, 1 << 20);
    FAIL() << "a grid of 9 M nodes in 1 MiB";
  } catch (const MemoryLimitError& error) {
    const std::string text = error.what();
    const double fitting = std::stod(text.substr(text.rfind("voxels of ") + 10));
    EXPECT_NO_THROW(sample_displacements(&wave, box, fitting, 1 << 20)) << text;
  }
}

TEST(DisplacementImage, StopsWhenAsked) {
  const Progress stopped{.report = {}, .cancelled = [] { return true; }};
  EXPECT_THROW(sample_displacements(&wave, box, 0.1, plenty, stopped), Interrupted);
}

}  // namespace
}  // namespace bespoke
