#include "bespoke/registration/detail/anchor_start.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cmath>

#include "bespoke/error.h"
#include "bespoke/pipeline/fit_mapping.h"
#include "bespoke/principal_widths.h"
#include "bespoke/surface_fit/matching/facing.h"
#include "samples.h"
#include "support/error_message.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

/// Points drawn to their plane, and off it by chance as far as that leaves of them.
Points flattened(const Points& x, double flatness, unsigned seed) {
  if (flatness == 1) return x;
  const PrincipalWidths principal = principal_widths(x);
  const Vector3 normal = principal.directions.col(2), centre = x.rowwise().mean();
  const double chance = flatness * principal.widths[2] / std::sqrt(double(x.cols()));
  const Eigen::RowVectorXd off = flatness * (normal.transpose() * (x.colwise() - centre)) +
                                 chance * test::random_points(x.cols(), seed).row(0);
  return x - normal * (normal.transpose() * (x.colwise() - centre)) + normal * off;
}

TriangleMesh mirror_image(TriangleMesh mesh) {
  mesh.vertices.row(0) *= -1;
  mesh.faces.row(1).swap(mesh.faces.row(2));
  return mesh;
}

/// A sample's source and first target with flattened anchors.
struct FlatPair {
  TriangleMesh source, target;
  Anchors anchors;

  FlatPair(const Sample& sample, double flatness, unsigned seed)
      : source(sample.source), target(sample.targets.front().mesh) {
    anchors.pairs = sample.targets.front().anchors;
    const Points a = flattened(source_points(anchors), flatness, seed);
    const Points b = flattened(target_points(anchors), flatness, seed + 1000);
    for (std::size_t k = 0; k < anchors.pairs.size(); ++k) {
      anchors.pairs[k].a = a.col(static_cast<Eigen::Index>(k));
      anchors.pairs[k].b = b.col(static_cast<Eigen::Index>(k));
    }
  }

  void mirror() {
    target = mirror_image(target);
    for (AnchorPair& pair : anchors.pairs) pair.b[0] *= -1;
  }

  AnchorStart start() const { return start_by_anchors(anchors, spline_weights(anchors), source, target); }
};

constexpr std::array flatnesses{1.0, 0.3, 0.1, 0.03, 1e-2, 1e-3, 1e-4};

class AnchorStartOfSample : public ::testing::TestWithParam<const char*> {};

TEST_P(AnchorStartOfSample, IsNeverRefusedForFlatAnchors) {
  const Sample sample = make_sample(GetParam());
  const TriangleMesh& target = sample.targets.front().mesh;
  for (const double flatness : flatnesses)
    for (unsigned seed = 1; seed <= 4; ++seed) {
      const FlatPair pair(sample, flatness, seed);
      AnchorStart start;
      ASSERT_NO_THROW(start = pair.start()) << GetParam() << ' ' << flatness << ' ' << seed;
      EXPECT_GT(start.alignment.affine.linear.determinant(), 0) << flatness << ' ' << seed;
      const Points placed = start.alignment.similarity * sample.source.vertices;
      EXPECT_FALSE(faces_away({placed, sample.source.faces}, target)) << flatness << ' ' << seed;
    }
}

TEST_P(AnchorStartOfSample, RefusesAMirrorImageAndNamesTheAnchorsThatSaySo) {
  const Sample sample = make_sample(GetParam());
  for (const double flatness : {1.0, 0.7}) {
    FlatPair pair(sample, flatness, 1);
    pair.mirror();
    const std::string message = test::error_message<InvalidInput>([&] { pair.start(); });
    EXPECT_THAT(message, ::testing::HasSubstr("mirror image of the other")) << flatness;
    EXPECT_THAT(message, ::testing::HasSubstr("the anchors that say so: \"")) << flatness;
  }
}

INSTANTIATE_TEST_SUITE_P(Samples, AnchorStartOfSample, ::testing::Values("dress", "shoe", "glove"));

// Anchors along a line leave the turn about it to the surfaces.
TEST(AnchorStart, TurnsAboutALineByTheSurfaces) {
  TriangleMesh source = shapes::icosphere(3);
  source.vertices = Vector3(0.3, 1, 3).asDiagonal() * source.vertices;
  TriangleMesh target = source;
  const Matrix3 quarter = Eigen::AngleAxisd(1.57, Vector3::UnitZ()).toRotationMatrix();
  target.vertices = quarter * target.vertices;
  Anchors anchors;
  const Points chance = test::random_points(16, 3);
  for (int k = 0; k < 8; ++k) {
    const Vector3 on_axis(0, 0, 0.8 * k - 2.8);
    anchors.pairs.push_back({"", on_axis + 0.01 * chance.col(k), on_axis + 0.03 * chance.col(8 + k)});
  }
  const AnchorStart start = start_by_anchors(anchors, spline_weights(anchors), source, target);
  const Points placed = start.alignment.similarity * source.vertices;
  EXPECT_LT(SimilarityDistance(source, target)(start.alignment.similarity), 0.05);
  EXPECT_LT((start.target_from_source * source.vertices - placed).colwise().norm().maxCoeff(), 0.1);
}

/// Bent about the y axis by an angle that grows along z.
Points bent_along_z(const Points& x, double angle_per_length) {
  Points y = x;
  for (auto&& place : y.colwise())
    place = Eigen::AngleAxisd(angle_per_length * place.z(), Vector3::UnitY()) * Vector3(place);
  return y;
}

// A bend leaves more than a thin body is wide; anchors all over it are interpolated nevertheless.
TEST(AnchorStart, TakesAnAffineMapFromAnchorsAllOverABentBody) {
  TriangleMesh source = shapes::icosphere(3);
  source.vertices = Vector3(0.3, 1, 3).asDiagonal() * source.vertices;
  const TriangleMesh target{bent_along_z(source.vertices, 0.4), source.faces};
  Anchors everywhere, on_one_side;
  for (Eigen::Index k = 0; k < source.vertices.cols(); k += 5) {
    const AnchorPair pair{"", source.vertices.col(k), target.vertices.col(k)};
    everywhere.pairs.push_back(pair);
    if (pair.a.x() > 0.25) on_one_side.pairs.push_back(pair);
  }
  const AnchorStart start = start_by_anchors(everywhere, spline_weights(everywhere), source, target);
  EXPECT_FALSE(start.alignment.determines_affine_map());
  EXPECT_TRUE(start.determines_affine_map);
  EXPECT_FALSE(
      start_by_anchors(on_one_side, spline_weights(on_one_side), source, target).determines_affine_map);
}

class FitSampleWithFlatAnchors : public ::testing::TestWithParam<double> {};

TEST_P(FitSampleWithFlatAnchors, LaysTheSourceOntoTheTarget) {
  const FlatPair pair(make_sample("shoe"), GetParam(), 7);
  FitOptions options;
  options.lambda = 0.1 * diagonal(pair.source.vertices);
  const Registration registered = fit_source_surface({pair.source, pair.target, pair.anchors}, options);
  EXPECT_LT(registered.summary.surface->after.median, 1e-3 * diagonal(pair.source.vertices));
}

INSTANTIATE_TEST_SUITE_P(Flatness, FitSampleWithFlatAnchors, ::testing::Values(0.03, 1e-4));

}  // namespace
}  // namespace bespoke
