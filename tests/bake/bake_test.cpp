#include "bespoke/bake/bake.h"

#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>

#include "bespoke/error.h"
#include "bespoke/lattice/baked_map.h"
#include "support/analytic_map.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using testing::HasSubstr;

AffineMap some_affine() {
  AffineMap affine;
  affine.linear << 1.1, 0.1, 0, -0.1, 0.9, 0.05, 0, 0.02, 1.05;
  affine.offset << 0.1, 0.2, -0.3;
  return affine;
}

AnalyticMap two_bumps() {
  return AnalyticMap(
      {{Vector3(0, 0, 0), 1.0, Vector3(0.1, 0.05, -0.02)}, {Vector3(1, 0.5, 0), 0.7, Vector3(0, -0.1, 0.1)}},
      some_affine());
}

BakeOptions uniform(double voxel_size) {
  BakeOptions options;
  options.tolerance = 1e-3;
  options.voxel_size = voxel_size;
  options.error_points = 50000;
  return options;
}

TEST(Bake, ReproducesAffineMapExactly) {
  BakeOptions options;
  options.tolerance = 1e-3;
  const AnalyticMap without_support({}, some_affine());
  EXPECT_TRUE(bake(without_support, options).pyramid.levels.empty());
  const AnalyticMap with_support({{Vector3::Zero(), 1.0, Vector3::Zero()}}, some_affine());
  const Bake baked = bake(with_support, options);
  EXPECT_TRUE(baked.pyramid.levels.empty());
  EXPECT_TRUE(baked.summary.tolerance_met);
  const Points x = Points::Random(3, 100);
  EXPECT_EQ(BakedMap(some_affine(), baked.pyramid)(x), some_affine() * x);
}

TEST(Bake, ConvergesWithOrderTwo) {
  const AnalyticMap map = two_bumps();
  const double coarse = bake(map, uniform(0.08)).summary.error.max;
  const double fine = bake(map, uniform(0.04)).summary.error.max;
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.15);
}

TEST(Bake, IsExactlyAffineBeyondTheBandAndContinuousIntoIt) {
  const AnalyticMap map = two_bumps();
  const BakedMap baked(map.affine(), bake(map, uniform(0.05)).pyramid);
  const double length = 2.7;  // beyond the support and the leaves that hold its level boundary
  Points directions = Points::Random(3, 50);
  directions.colwise().normalize();
  for (Eigen::Index i = 0; i < directions.cols(); ++i) {
    const Vector3 far = length * directions.col(i);
    EXPECT_EQ(Vector3(baked.displacement(far)), Vector3::Zero());
    const int steps = 20000;
    Points walk(3, steps + 1);
    for (int n = 0; n <= steps; ++n) walk.col(n) = (n * length / steps) * directions.col(i);
    const Points u = baked.displacement(walk);
    double largest_jump = 0;
    for (int n = 0; n < steps; ++n) largest_jump = std::max(largest_jump, (u.col(n + 1) - u.col(n)).norm());
    // |∇u| < 0.7 for these bumps.
    EXPECT_LE(largest_jump, 0.7 * length / steps);
  }
}

TEST(Bake, MeetsTheTolerance) {
  const AnalyticMap map = two_bumps();
  for (const double tolerance : {1e-3, 2e-4}) {
    BakeOptions options;
    options.tolerance = tolerance;
    options.error_points = 100000;
    const Bake baked = bake(map, options);
    EXPECT_TRUE(baked.summary.tolerance_met) << to_string(baked.summary);
    EXPECT_LE(baked.summary.error.max, tolerance);
    EXPECT_GE(baked.summary.error.count, 100000u);
    EXPECT_NO_THROW(require_valid(baked.pyramid));
    // An error that the bake did not measure itself.
    const Points x = 1.5 * Points::Random(3, 50000);
    const BakedMap result(map.affine(), baked.pyramid);
    EXPECT_LE((result.displacement(x) - map.displacement(x)).colwise().norm().maxCoeff(), 1.1 * tolerance);
  }
}

TEST(Bake, NeedsFarFewerVoxelsThanOneLevelOfTheSameError) {
  const AnalyticMap map(
      {{Vector3::Zero(), 1.0, Vector3(0.1, 0.05, 0)}, {Vector3(0.6, 0.1, 0), 0.06, Vector3(0, 0.01, 0)}});
  BakeOptions options;
  options.tolerance = 5e-4;
  options.error_points = 100000;
  const Bake adaptive = bake(map, options);
  EXPECT_TRUE(adaptive.summary.tolerance_met);
  // Without the narrow bump's last halving one level misses the error.
  const Bake one_level = bake(map, uniform(1.5 * adaptive.summary.levels.back().voxel_size));
  EXPECT_GT(one_level.pyramid.voxel_count(), 15 * adaptive.pyramid.voxel_count())
      << to_string(one_level.summary) << '\n'
      << to_string(adaptive.summary);
}

TEST(Bake, FollowsTheFrameOfTheSupport) {
  AffineMap frame;
  frame.linear << 2, 0, 0, 0, 0.5, 0.1, 0, 0, 1;
  frame.offset << 1, 2, 3;
  const AnalyticMap map({{Vector3(1, 2, 3), 1.0, Vector3(0.1, 0, 0)}}, {}, frame);
  const Bake baked = bake(map, uniform(0.02));
  EXPECT_LT(baked.summary.error.max, 1e-3);
  const Points x = 3 * Points::Random(3, 50000);
  const BakedMap result(map.affine(), baked.pyramid);
  EXPECT_LT((result.displacement(x) - map.displacement(x)).colwise().norm().maxCoeff(), 1e-3);
}

TEST(Bake, GivesTheSameBytesAtAnyNumberOfThreads) {
  const AnalyticMap map = two_bumps();
  for (const bool one_level : {true, false}) {
    BakeOptions options = uniform(0.05);
    if (!one_level) options.voxel_size.reset();
    const Bake expected = bake(map, options);
    for (const int threads : {1, 2, 8}) {
      const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                        static_cast<std::size_t>(threads));
      const Bake found = bake(map, options);
      ASSERT_EQ(found.pyramid.levels.size(), expected.pyramid.levels.size());
      for (std::size_t level = 0; level < found.pyramid.levels.size(); ++level) {
        EXPECT_EQ(found.pyramid.levels[level].leaves, expected.pyramid.levels[level].leaves);
        EXPECT_EQ(found.pyramid.levels[level].values, expected.pyramid.levels[level].values);
      }
      EXPECT_EQ(found.summary.error.max, expected.summary.error.max);
    }
  }
}

TEST(Bake, RefusesMemoryBeforeTakingItAndSaysWhatFits) {
  BakeOptions options = uniform(0.005);
  options.max_memory = std::size_t{48} << 20;
  std::string message;
  try {
    bake(two_bumps(), options);
  } catch (const MemoryLimitError& error) {
    message = error.what();
  }
  ASSERT_THAT(message, HasSubstr("voxels of 0.005"));
  const std::size_t at = message.find("; voxels of ");
  ASSERT_NE(at, std::string::npos) << message;
  options.voxel_size = 1.001 * std::stod(message.substr(at + 12));
  EXPECT_NO_THROW(bake(two_bumps(), options)) << message;
  options.max_memory = 1000;
  EXPECT_THROW(bake(two_bumps(), options), MemoryLimitError);
}

TEST(Bake, RefusesVoxelsFarTooFineWithoutCountingThem) {
  for (const double voxel_size : {1e-4, 1e-5, 1e-6})  // up to 10^15 leaves
    EXPECT_THROW(bake(two_bumps(), uniform(voxel_size)), MemoryLimitError) << voxel_size;
  EXPECT_THROW(bake(two_bumps(), uniform(1e-12)), InvalidInput);
}

TEST(Bake, RefusesValuesOutOfRange) {
  BakeOptions options;
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    options.tolerance = bad;
    EXPECT_THROW(bake(two_bumps(), options), InvalidInput);
    options.tolerance = 1e-3;
    options.voxel_size = bad;
    EXPECT_THROW(bake(two_bumps(), options), InvalidInput);
    options.voxel_size.reset();
    options.max_face_turn = bad;
    EXPECT_THROW(bake(two_bumps(), options), InvalidInput);
    options.max_face_turn = 180;
  }
}

TEST(Bake, RefusesAMapThatIsNotFinite) {
  const AnalyticMap map({{Vector3::Zero(), 1.0, Vector3(std::nan(""), 0, 0)}});
  EXPECT_THROW(bake(map, uniform(0.1)), InvalidInput);
}

TEST(Bake, MeasuresWhatHalfPrecisionStores) {
  const AnalyticMap map = two_bumps();
  BakeOptions options;
  options.tolerance = 2e-4;
  options.error_points = 50000;
  options.precision = ValuePrecision::half;
  const Bake baked = bake(map, options);
  EXPECT_TRUE(baked.summary.tolerance_met) << to_string(baked.summary);
  EXPECT_NO_THROW(require_valid(baked.pyramid));  // every value is of half precision
  for (const PyramidLevel& level : baked.pyramid.levels)
    for (const float value : level.values) ASSERT_EQ(value, rounded_to_half(value));
  const Points x = 1.5 * Points::Random(3, 50000);
  const BakedMap result(map.affine(), baked.pyramid);
  EXPECT_LE((result.displacement(x) - map.displacement(x)).colwise().norm().maxCoeff(),
            1.1 * options.tolerance);
}

TEST(Bake, RefusesWhatHalfPrecisionCannotHold) {
  const AnalyticMap map({{Vector3::Zero(), 1e6, Vector3(1e5, 0, 0)}});
  BakeOptions options;
  options.tolerance = 1e3;
  options.error_points = 1000;
  EXPECT_NO_THROW(bake(map, options));
  options.precision = ValuePrecision::half;
  EXPECT_THROW(bake(map, options), InvalidInput);
}

// Twice the identity's displacement on one side of a sphere, none on the other.
class TornMap : public AnalyticMap {
 public:
  TornMap() : AnalyticMap({{Vector3::Zero(), 1.0, Vector3(0.2, 0, 0)}}) {}
  Points displacement(const Points& x) const override {
    Points u = AnalyticMap::displacement(x);
    for (Eigen::Index i = 0; i < x.cols(); ++i)
      if (x.col(i).norm() > 0.3) u.col(i).setZero();
    return u;
  }
};

TEST(Bake, OfAMapThatJumpsEndsAndSaysThatItMisses) {
  BakeOptions options;
  options.tolerance = 4e-3;
  options.error_points = 20000;
  const Bake baked = bake(TornMap(), options);
  EXPECT_FALSE(baked.summary.tolerance_met);
  EXPECT_GE(baked.summary.levels.back().voxel_size, options.tolerance / 2);
}

TEST(Bake, RefusesEarlyAndAdvisesAToleranceThatFits) {
  BakeOptions options;
  options.tolerance = 4e-4;
  options.error_points = 20000;
  options.max_memory = std::size_t{600} << 20;
  class Counted : public TornMap {
   public:
    Points displacement(const Points& x) const override {
      points += x.cols();
      return TornMap::displacement(x);
    }
    mutable std::atomic<Eigen::Index> points{0};
  };
  const Counted map;
  std::string message;
  try {
    bake(map, options);
  } catch (const MemoryLimitError& error) {
    message = error.what();
  }
  const std::string before = "; a tolerance of ";
  const std::size_t at = message.find(before);
  ASSERT_NE(at, std::string::npos) << message;
  EXPECT_LT(map.points, 3'000'000);
  options.tolerance = std::stod(message.substr(at + before.size()));
  const Bake fitting = bake(map, options);
  EXPECT_LE(fitting.summary.peak_bytes, options.max_memory);
}

TEST(RoundedToHalf, IsTheNearestNumberOfElevenBits) {
  EXPECT_EQ(rounded_to_half(0.0f), 0.0f);
  EXPECT_EQ(rounded_to_half(1.0f), 1.0f);
  EXPECT_EQ(rounded_to_half(1.0f + 0x1p-11f), 1.0f);  // a tie, to even
  EXPECT_EQ(rounded_to_half(1.0f + 0x1.8p-11f), 1.0f + 0x1p-10f);
  EXPECT_EQ(rounded_to_half(-0x1p-24f), -0x1p-24f);  // the least
  EXPECT_EQ(rounded_to_half(0x1p-26f), 0.0f);
  EXPECT_EQ(rounded_to_half(65519.0f), 65504.0f);
  EXPECT_TRUE(std::isinf(rounded_to_half(65520.0f)));
}

TEST(Bake, StopsWhenAsked) {
  Progress progress;
  progress.cancelled = [] { return true; };
  EXPECT_THROW(bake(two_bumps(), uniform(0.05), progress), Interrupted);
}

TEST(BakeSummary, PrintsOneLine) {
  const std::string line = to_string(bake(two_bumps(), uniform(0.1)).summary);
  EXPECT_THAT(line, HasSubstr("finest voxel 0.1"));
  EXPECT_EQ(line.find('\n'), std::string::npos);
}

// With fewer leaves than it needs a bake spends them on the largest errors, and names the places that went
// without.
TEST(Bake, KeepsToItsLeavesAndNamesWhereItMissesTheTolerance) {
  const AnalyticMap map = two_bumps();
  BakeOptions options;
  options.tolerance = 1e-4;
  options.error_points = 50000;
  const Bake whole = bake(map, options);
  ASSERT_TRUE(whole.summary.tolerance_met);
  EXPECT_TRUE(whole.summary.relaxed.empty());
  options.max_leaves = whole.pyramid.leaf_count() / 2;
  const Bake limited = bake(map, options);
  EXPECT_LE(limited.pyramid.leaf_count(), *options.max_leaves);
  EXPECT_FALSE(limited.summary.tolerance_met);
  ASSERT_FALSE(limited.summary.relaxed.empty());
  for (const RelaxedRegion& region : limited.summary.relaxed)
    EXPECT_GT(region.error, 0.8 * options.tolerance);
  const BakedMap baked(map.affine(), limited.pyramid);
  const Points x = 2 * Points::Random(3, 50000);
  const Points error = baked.displacement(x) - map.displacement(x);
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    if (error.col(i).norm() > 1.5 * options.tolerance) {
      EXPECT_TRUE(std::any_of(limited.summary.relaxed.begin(), limited.summary.relaxed.end(),
                              [&](const RelaxedRegion& region) { return region.box.contains(x.col(i)); }));
    }
}

// Products lie on the model and around it.
TEST(Bake, SpendsFewLeavesNearTheSurfaceFirst) {
  const Vector3 here(-1.5, 0, 0), there(1.5, 0, 0), amplitude(0.1, 0.05, -0.02);
  const AnalyticMap map({{here, 1.0, amplitude}, {there, 1.0, amplitude}});
  const auto sphere = [](const Vector3& center) {
    TriangleMesh mesh = shapes::icosphere(4);
    mesh.vertices = (0.6 * mesh.vertices).colwise() + center;
    return mesh;
  };
  const TriangleMesh surface = sphere(here);
  BakeOptions options;
  options.tolerance = 1e-4;
  options.error_points = 50000;
  options.surface = &surface;
  options.max_leaves = bake(map, options).pyramid.leaf_count() / 2;
  const BakedMap baked(map.affine(), bake(map, options).pyramid);
  const auto error = [&](const Vector3& center) {
    const Points x = sphere(center).vertices;
    return (baked.displacement(x) - map.displacement(x)).colwise().norm().mean();
  };
  EXPECT_LT(error(here), 0.5 * error(there));
}

// A surface across a bump that is hardly larger than the tolerance, and much narrower than another.
struct SteepPlace {
  AnalyticMap map{{{Vector3::Zero(), 1.0, Vector3(0.1, 0.05, -0.02)},
                   {Vector3(0.3, 0.2, 0), 6e-3, Vector3(0, 0, 2.2e-3)}},
                  some_affine()};
  TriangleMesh surface = shapes::square_grid(20);
  BakeOptions options;

  SteepPlace() {
    surface.vertices = (0.02 * surface.vertices).colwise() + Vector3(0.29, 0.19, 0);
    options.tolerance = 1e-3;
    options.error_points = 50000;
    options.surface = &surface;
  }

  std::size_t misoriented_faces(const Pyramid& pyramid, double degrees) const {
    const auto normals = [&](const ElasticMap& by) {
      return face_normals({by(surface.vertices), surface.faces});
    };
    const Eigen::VectorXd cosines =
        normals(BakedMap(map.affine(), pyramid)).cwiseProduct(normals(map)).colwise().sum();
    return static_cast<std::size_t>((cosines.array() < std::cos(degrees * std::numbers::pi / 180)).count());
  }
};

// The tolerance alone leaves small faces turned by any angle.
TEST(Bake, TurnsNoFaceOfTheSurfaceFartherThanAsked) {
  SteepPlace place;
  place.options.max_face_turn = 180;
  const Bake by_tolerance = bake(place.map, place.options);
  ASSERT_TRUE(by_tolerance.summary.tolerance_met);
  for (const double degrees : {15.0, 5.0}) {
    EXPECT_GT(place.misoriented_faces(by_tolerance.pyramid, degrees), 0u);
    place.options.max_face_turn = degrees;
    const Bake baked = bake(place.map, place.options);
    EXPECT_EQ(place.misoriented_faces(baked.pyramid, degrees), 0u);
    EXPECT_EQ(baked.summary.misoriented_faces, 0u);
  }
}

TEST(Bake, CountsTheFacesThatItsLeavesDoNotTurnBack) {
  SteepPlace place;
  place.options.max_face_turn = 5;
  place.options.max_leaves = 40;
  const Bake baked = bake(place.map, place.options);
  EXPECT_GT(baked.summary.misoriented_faces, 0u);
  EXPECT_EQ(baked.summary.misoriented_faces, place.misoriented_faces(baked.pyramid, 5));
  place.options.voxel_size = 4e-3;
  const Bake one_level = bake(place.map, place.options);
  EXPECT_GT(one_level.summary.misoriented_faces, 0u);
  EXPECT_EQ(one_level.summary.misoriented_faces, place.misoriented_faces(one_level.pyramid, 5));
}

// No voxel resolves what is thinner than the smallest.
TEST(Bake, SpendsNoLeafOnFacesThinnerThanItsSmallestVoxel) {
  const auto baked = [](SteepPlace place, double height) {
    // Of each face what lies next to a side.
    const TriangleMesh& grid = place.surface;
    TriangleMesh strips{Points(3, 3 * grid.faces.cols()), Faces(3, grid.faces.cols())};
    for (int face = 0; face < grid.faces.cols(); ++face) {
      const Vector3 a = grid.vertices.col(grid.faces(0, face)), b = grid.vertices.col(grid.faces(1, face));
      const Vector3 inwards = Vector3::UnitZ().cross(b - a).normalized();
      strips.vertices.middleCols<3>(3 * face) << a, b, (a + b) / 2 + height * inwards;
      strips.faces.col(face) << 3 * face, 3 * face + 1, 3 * face + 2;
    }
    place.options.max_face_turn = 5;
    place.surface = strips;
    place.options.surface = &place.surface;
    return bake(place.map, place.options);
  };
  const SteepPlace place;
  const double smallest = place.options.tolerance / 2;
  EXPECT_GT(baked(place, 1.1 * smallest).pyramid.leaf_count(),
            baked(place, 0.5 * smallest).pyramid.leaf_count());
  EXPECT_EQ(baked(place, 0.5 * smallest).summary.misoriented_faces, 0u);
}

// What is kept for folds goes to the tolerance where nothing folds.
TEST(Bake, UsesAllOfItsLeavesWhereNothingFolds) {
  const AnalyticMap map = two_bumps();
  BakeOptions options;
  options.tolerance = 1e-4;
  options.error_points = 50000;
  options.max_leaves = bake(map, options).pyramid.leaf_count() * 21 / 20;
  const Bake limited = bake(map, options);
  EXPECT_LE(limited.pyramid.leaf_count(), *options.max_leaves);
  EXPECT_TRUE(limited.summary.tolerance_met);
  EXPECT_TRUE(limited.summary.relaxed.empty());
}

}  // namespace
}  // namespace bespoke
