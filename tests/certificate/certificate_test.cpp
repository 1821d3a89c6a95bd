#include "bespoke/certificate/certificate.h"

#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <Eigen/LU>
#include <cmath>
#include <map>
#include <random>

#include "bespoke/error.h"
#include "bespoke/lattice/baked_map.h"

namespace bespoke {
namespace {

using Cell = std::array<int, 3>;

template <class Value>
Pyramid one_level(const std::vector<LeafCoordinates>& leaves, double voxel_size, const Value& value) {
  Pyramid pyramid;
  pyramid.levels.push_back({voxel_size, leaves, {}});
  for (const LeafCoordinates& leaf : leaves)
    for (int i = 0; i < 8; ++i)
      for (int j = 0; j < 8; ++j)
        for (int k = 0; k < 8; ++k) {
          const Vector3 u = value(8 * leaf[0] + i, 8 * leaf[1] + j, 8 * leaf[2] + k);
          for (int c = 0; c < 3; ++c) pyramid.levels[0].values.push_back(static_cast<float>(u[c]));
        }
  return pyramid;
}

// det ∇((1−t) x + t E) at 9³ points of a cell, by the look-up's gradients: shares no code with the bound.
double min_sampled_determinant(const BakedMap& map, const Vector3& corner, double voxel_size, double t) {
  Points x(3, 729);
  for (int n = 0; n < 729; ++n)
    // Just inside: gradients on a face belong to the upper cell.
    x.col(n) =
        corner + voxel_size * (Vector3(n / 81, n / 9 % 9, n % 9) / 8 * (1 - 2e-9) + Vector3::Constant(1e-9));
  const Points gradient = map.displacement_gradient(x);
  double least = std::numeric_limits<double>::infinity();
  for (int n = 0; n < 729; ++n)
    least = std::min(least, ((1 - t) * Matrix3::Identity() +
                             t * (map.affine().linear + Matrix3(gradient.middleCols<3>(3 * n))))
                                .determinant());
  return least;
}

struct Comparison {
  int certified = 0;
  int folded = 0;
};

// Every cell of one leaf and its rim against dense samples.
Comparison compare(const Pyramid& pyramid, const AffineMap& affine, double t) {
  const Certificate certificate = certify(pyramid, affine, t);
  const double voxel_size = pyramid.levels[0].voxel_size;
  std::map<Cell, double> folded;
  for (const FoldedCell& place : certificate.places) {
    const Vector3 lattice = (place.center - pyramid.origin) / voxel_size - Vector3::Constant(0.5);
    folded[{static_cast<int>(std::lround(lattice.x())), static_cast<int>(std::lround(lattice.y())),
            static_cast<int>(std::lround(lattice.z()))}] = place.determinant;
  }
  EXPECT_EQ(certificate.undecided, 0u);
  EXPECT_EQ(folded.size(), certificate.folded);
  EXPECT_EQ(certificate.folded + certificate.certified, 729u);
  const BakedMap map(affine, pyramid);
  Comparison seen;
  const LeafCoordinates first = pyramid.levels[0].leaves[0];
  for (int i = 8 * first[0] - 1; i < 8 * first[0] + 8; ++i)
    for (int j = 8 * first[1] - 1; j < 8 * first[1] + 8; ++j)
      for (int k = 8 * first[2] - 1; k < 8 * first[2] + 8; ++k) {
        const double sampled =
            min_sampled_determinant(map, pyramid.origin + voxel_size * Vector3(i, j, k), voxel_size, t);
        const auto place = folded.find({i, j, k});
        if (place == folded.end()) {
          ++seen.certified;
          EXPECT_GT(sampled, 0) << i << ' ' << j << ' ' << k;
          EXPECT_GE(sampled, certificate.min_determinant - 1e-9);
        } else {
          ++seen.folded;
          EXPECT_LE(place->second, 0);
          // The samples may miss a small fold, but not by much.
          EXPECT_LE(sampled, 0.1) << i << ' ' << j << ' ' << k;
        }
      }
  return seen;
}

AffineMap sheared() {
  AffineMap affine;
  affine.linear << 1.1, 0.2, 0, 0, 0.9, 0.1, 0.05, 0, 1;
  return affine;
}

TEST(Certify, AgreesWithDenseSamplesOnRandomCells) {
  std::mt19937 engine(1);
  Comparison total;
  for (const double amplitude : {0.1, 0.3, 0.6, 0.9}) {
    std::uniform_real_distribution<double> value(-amplitude, amplitude);
    const Pyramid pyramid = one_level({{2, -1, 0}}, 0.25, [&](int, int, int) {
      return Vector3(0.25 * Vector3(value(engine), value(engine), value(engine)));
    });
    const Comparison seen = compare(pyramid, sheared(), 1);
    total.certified += seen.certified;
    total.folded += seen.folded;
  }
  EXPECT_GT(total.certified, 1000);
  EXPECT_GT(total.folded, 500);
}

// Central differences over two cells see nothing of a field that alternates from node to node.
TEST(Certify, SeesTheCheckerboardThatCentralDifferencesPass) {
  const auto checkerboard = [](double amplitude) {
    return one_level({{0, 0, 0}}, 1.0, [&](int i, int j, int k) {
      return Vector3(Vector3::Constant((i + j + k) % 2 == 0 ? amplitude : -amplitude));
    });
  };
  // Every second cell flips: ∂u/∂x alternates between ±2 a: with three equal components the least det is
  // 1 − 6 a (at a corner).
  EXPECT_EQ(certify(checkerboard(0.16), {}).folded, 0u);
  EXPECT_GT(certify(checkerboard(0.16), {}).min_determinant, 1 - 6 * 0.1601 - 1e-6);
  EXPECT_GE(certify(checkerboard(0.17), {}).folded, 171u);
  compare(checkerboard(0.16), {}, 1);
  compare(checkerboard(0.17), {}, 1);
  compare(checkerboard(0.4), {}, 1);
}

TEST(Certify, SeesFoldsInsideACellWhoseCornersAreAllRight) {
  // Twisting opposite faces of cells against each other: corners keep det > 0 far longer than centres do.
  std::mt19937 engine(2);
  for (const double angle : {0.5, 0.9, 1.2}) {
    const Pyramid pyramid = one_level({{0, 0, 0}}, 1.0, [&](int i, int j, int k) {
      const double turn = k % 2 == 0 ? angle : -angle;
      const Vector3 arm(i % 2 - 0.5, j % 2 - 0.5, 0);
      const Vector3 turned(std::cos(turn) * arm.x() - std::sin(turn) * arm.y(),
                           std::sin(turn) * arm.x() + std::cos(turn) * arm.y(), 0);
      return Vector3(turned - arm);
    });
    compare(pyramid, {}, 1);
  }
}

TEST(Certify, HoldsForEveryTime) {
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> value(-0.3, 0.3);
  const Pyramid pyramid = one_level(
      {{0, 0, 0}}, 1.0, [&](int, int, int) { return Vector3(value(engine), value(engine), value(engine)); });
  for (const double t : {0.0, 0.3, 0.6, 1.0, 1.5}) compare(pyramid, sheared(), t);
  EXPECT_EQ(certify(pyramid, sheared(), 0).folded, 0u);
}

TEST(Certify, CountsTheFinestCellsOfNestedLevels) {
  Pyramid pyramid;
  pyramid.levels.push_back({1, {{0, 0, 0}}, std::vector<float>(3 * leaf_nodes, 0.01f)});
  EXPECT_EQ(certify(pyramid, {}).certified, 729u);
  pyramid.levels.push_back({0.5, {{1, 0, 1}}, std::vector<float>(3 * leaf_nodes, 0.01f)});
  // The child touches 9 of its cells along each axis; 5 coarse cells are split into 10.
  EXPECT_EQ(certify(pyramid, {}).certified, 729u - 125u + 1000u);
  EXPECT_TRUE(certify(pyramid, {}).is_bijection());
}

TEST(Certify, SumsTheLevels) {
  // The fine level undoes the coarse one's fold in its inside.
  const auto steep = [](int i, int, int) { return Vector3(i == 3 || i == 4 ? 3 - i : 0, 0, 0); };
  Pyramid pyramid =
      one_level({{0, 0, 0}}, 1.0, [&](int i, int j, int k) { return Vector3(1.5 * steep(i, j, k)); });
  const Certificate coarse = certify(pyramid, {});
  const auto folds_at = [](const Certificate& certificate, const Vector3& at, double half) {
    for (const FoldedCell& place : certificate.places)
      if ((place.center - at).cwiseAbs().maxCoeff() < half) return true;
    return false;
  };
  EXPECT_TRUE(folds_at(coarse, Vector3(3.5, 2.5, 2.5), 0.1));
  PyramidLevel fine{0.5, {{0, 0, 0}}, {}};
  const BakedMap map({}, pyramid);
  for (int n = 0; n < leaf_nodes; ++n) {
    const Vector3 u = map.displacement(0.5 * Vector3(n / 64, n / 8 % 8, n % 8));
    for (int c = 0; c < 3; ++c) fine.values.push_back(static_cast<float>(-u[c]));
  }
  pyramid.levels.push_back(fine);
  EXPECT_FALSE(folds_at(certify(pyramid, {}), Vector3(3.25, 2.25, 2.25), 0.3));
}

TEST(Certify, AffineMapNeedsAPositiveDeterminant) {
  AffineMap mirrored;
  mirrored.linear = Vector3(1, 1, -1).asDiagonal();
  EXPECT_FALSE(certify(Pyramid{}, mirrored).is_bijection());
  EXPECT_TRUE(certify(Pyramid{}, sheared()).is_bijection());
  EXPECT_EQ(certify(Pyramid{}, sheared()).affine_determinant, sheared().linear.determinant());
}

TEST(Certify, FlattenedCellsAreFolded) {
  // u = −x: all of space in the leaf goes to one plane, det is 0 everywhere.
  const Pyramid pyramid = one_level({{0, 0, 0}}, 1.0, [](int i, int, int) { return Vector3(-i, 0, 0); });
  const Certificate certificate = certify(pyramid, {});
  EXPECT_GE(certificate.folded + certificate.undecided, 343u);
  EXPECT_FALSE(certificate.is_bijection());
}

TEST(Certify, IsTheSameAtAnyNumberOfThreads) {
  std::mt19937 engine(4);
  std::uniform_real_distribution<double> value(-0.7, 0.7);
  std::vector<LeafCoordinates> leaves;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) leaves.push_back({i, j, 0});
  const Pyramid pyramid = one_level(
      leaves, 1.0, [&](int, int, int) { return Vector3(value(engine), value(engine), value(engine)); });
  const Certificate expected = certify(pyramid, {});
  EXPECT_GT(expected.folded, 0u);
  for (const std::size_t threads : {1, 2, 8}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    const Certificate found = certify(pyramid, {});
    EXPECT_EQ(found.certified, expected.certified);
    EXPECT_EQ(found.min_determinant, expected.min_determinant);
    ASSERT_EQ(found.places.size(), expected.places.size());
    for (std::size_t i = 0; i < found.places.size(); ++i)
      EXPECT_EQ(found.places[i].center, expected.places[i].center);
  }
}

TEST(Certify, RefusesWhatIsNotFinite) {
  EXPECT_THROW(certify(Pyramid{}, {}, std::nan("")), InvalidInput);
  AffineMap affine;
  affine.linear(0, 0) = std::nan("");
  EXPECT_THROW(certify(Pyramid{}, affine), InvalidInput);
}

TEST(Certificate, PrintsOneLine) {
  const std::string line = to_string(certify(Pyramid{}, {}));
  EXPECT_THAT(line, testing::HasSubstr("bijection"));
  EXPECT_EQ(line.find('\n'), std::string::npos);
}

}  // namespace
}  // namespace bespoke
