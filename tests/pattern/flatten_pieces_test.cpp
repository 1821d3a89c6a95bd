#include "bespoke/pattern/flatten_pieces.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "bespoke/error.h"
#include "bespoke/pattern/flattening/flat_faces.h"
#include "bespoke/pattern/flattening/flat_start.h"
#include "bespoke/pattern/flattening/paired_seams.h"
#include "bespoke/pattern/self_overlap.h"
#include "pattern/bent_cloth.h"
#include "pattern/mesh_parts.h"
#include "support/error_message.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;

constexpr double of_the_diagonal = 1e-6;

template <class IsKept>
Piece piece_where(const IsKept& is_kept) {
  test::MeshPart part = test::part_of(test::ball(), is_kept);
  Piece piece = test::piece_of(std::move(part.mesh));
  piece.vertices = std::move(part.vertices);
  return piece;
}

/// What of a ball lies above a height, radii.
Piece cap(double height) {
  return piece_where([&](const Vector3& x) { return x.y() > 100 * height; });
}

TEST(FlattenPieces, UnrollsBentClothExactly) {
  const test::BentCloth flat =
      test::ruled_cloth({{0, 0}, {50, 10}, {90, 0}}, {{0, 80}, {50, 90}, {100, 80}}, 9);
  for (const FlatteningMethod method :
       {FlatteningMethod::rigid, FlatteningMethod::conformal, FlatteningMethod::authalic})
    for (const test::BentCloth& cloth :
         {flat, test::cylinder_cloth(), test::cylinder_cloth(60), test::cone_cloth()}) {
      const FlatPieces pieces = flatten_pieces({cloth.piece}, {}, {.method = method});
      EXPECT_LT(test::shape_difference(pieces.places.at(0), cloth.flat),
                of_the_diagonal * diagonal(cloth.piece.mesh.vertices));
    }
}

TEST(FlattenPieces, FlipsNoFaceOfACurvedPiece) {
  for (const double height : {0.5, 0.0, -0.5, -0.9}) {
    const Piece piece = cap(height);
    for (const FlatteningMethod method :
         {FlatteningMethod::rigid, FlatteningMethod::conformal, FlatteningMethod::authalic}) {
      const FlatPieces pieces = flatten_pieces({piece}, {}, {.method = method});
      EXPECT_TRUE(is_unflipped(piece.mesh, rest_faces(piece.mesh), pieces.places[0])) << height;
    }
  }
}

// The conformal image of a sphere's cap is that of the stereographic projection; equal areas are Lambert's.
TEST(FlattenPieces, MethodsKeepWhatTheySay) {
  const Piece piece = cap(0.0);
  const std::vector<RestFace> rest = rest_faces(piece.mesh);
  const auto mean = [&](FlatteningMethod method, const auto& deviation) {
    const FlatPieces pieces = flatten_pieces({piece}, {}, {.method = method});
    double sum = 0, area = 0;
    for (Eigen::Index f = 0; f < piece.mesh.faces.cols(); ++f) {
      const Eigen::Matrix2d jacobian =
          face_jacobian(rest[static_cast<std::size_t>(f)], piece.mesh.faces.col(f), pieces.places[0]);
      const Eigen::Vector2d stretches = jacobian.jacobiSvd().singularValues();
      sum += rest[static_cast<std::size_t>(f)].area * deviation(stretches[0], stretches[1]);
      area += rest[static_cast<std::size_t>(f)].area;
    }
    return sum / area;
  };
  const auto of_angles = [](double s, double t) { return s / t - 1; };
  const auto of_areas = [](double s, double t) { return std::abs(s * t - 1); };
  const auto of_lengths = [](double s, double t) { return (s - 1) * (s - 1) + (t - 1) * (t - 1); };
  EXPECT_LT(mean(FlatteningMethod::conformal, of_angles), mean(FlatteningMethod::rigid, of_angles) / 4);
  EXPECT_LT(mean(FlatteningMethod::authalic, of_areas), mean(FlatteningMethod::rigid, of_areas) / 4);
  for (const FlatteningMethod other : {FlatteningMethod::conformal, FlatteningMethod::authalic})
    EXPECT_LT(mean(FlatteningMethod::rigid, of_lengths), mean(other, of_lengths));
}

// A ball's cap in two unequal parts, which alone would become of different lengths along the cut.
TEST(FlattenPieces, PairedSeamsHaveOneLength) {
  const auto part = [](double side) {
    return piece_where([&](const Vector3& x) { return x.y() > -20 && side * (x.x() - 40) > 0; });
  };
  const std::vector<Piece> pieces{part(1), part(-1)};
  const std::vector<Seam> seams = paired_seams(pieces);
  ASSERT_EQ(seams.size(), 1u);
  const auto gap = [&](const FlatPieces& flat) {
    return std::abs(side_length(seams[0].sides[0], flat.places[0]) -
                    side_length(seams[0].sides[1], flat.places[1]));
  };
  EXPECT_GT(gap(flatten_pieces(pieces, {})), 2);
  EXPECT_LT(gap(flatten_pieces(pieces, seams)), 1);
}

TEST(TutteStart, IsInjective) {
  for (const Piece& piece : {cap(0.5), cap(-0.9), test::cone_cloth().piece}) {
    const std::vector<RestFace> rest = rest_faces(piece.mesh);
    const Eigen::Matrix2Xd flat = tutte_start(piece, rest);
    EXPECT_TRUE(is_unflipped(piece.mesh, rest, flat));
    EXPECT_FALSE(outline_crossing(flat, piece.outline));
  }
}

TEST(FlattenPieces, RefusesFacesWithoutArea) {
  TriangleMesh mesh = shapes::square_grid(1);
  mesh.vertices.col(3) = mesh.vertices.col(mesh.faces(0, 1));
  EXPECT_THAT(test::error_message<InvalidInput>([&] { flatten_pieces({test::piece_of(mesh)}, {}); }),
              HasSubstr("has no area"));
}

}  // namespace
}  // namespace bespoke
