#include "bespoke/surface_fit/detail/misoriented_faces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include "bespoke/surface_fit/detail/bends.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

constexpr int side = 12;  // squares
constexpr double square = 1.0 / side;

/// The vertex of the grid nearest to (x, y, 0).
int vertex_at(const TriangleMesh& grid, double x, double y) {
  Eigen::Index vertex = 0;
  (grid.vertices.colwise() - Vector3(x, y, 0)).colwise().squaredNorm().minCoeff(&vertex);
  return static_cast<int>(vertex);
}

double min_cosine(const TriangleMesh& before, const Points& after) {
  return face_normals(before).cwiseProduct(face_normals({after, before.faces})).colwise().sum().minCoeff();
}

/// With a shape like the surface before.
RepairedSurface repaired_between(const TriangleMesh& before, const Points& after,
                                 const FaceRepairSettings& settings = {}) {
  return repair_misoriented_faces({before.vertices, before, after}, settings);
}

/// The square with a pocket about a point, `depth` deep and narrow enough that its walls are steep.
Points with_pocket(const TriangleMesh& grid, const Vector3& middle, double depth) {
  Points pushed = grid.vertices;
  for (auto&& x : pushed.colwise()) x[2] -= depth * std::exp(-(x - middle).squaredNorm() / 0.01);
  return pushed;
}

TEST(RepairMisorientedFaces, LeavesASurfaceWithoutMisorientedFacesAsItIs) {
  const TriangleMesh grid = shapes::square_grid(side);
  Points after = grid.vertices;
  for (auto&& x : after.colwise()) x += Vector3(0.3 * x[1], 0.1 * x[0], 0.2 * std::sin(5 * x[0]));
  const RepairedSurface repaired = repaired_between(grid, after);
  EXPECT_EQ(repaired.vertices, after);
  EXPECT_EQ(repaired.repaired_vertices, 0u);
  EXPECT_EQ(repaired.misoriented_faces, 0u);
}

TEST(RepairMisorientedFaces, ResetsAVertexMovedAcrossItsNeighbours) {
  const TriangleMesh grid = shapes::square_grid(side);
  const Vector3 shift(0.2, -0.1, 0.4);
  Points after = grid.vertices.colwise() + shift;
  const int drawn = vertex_at(grid, 0.5, 0.5);
  after.col(drawn) += Vector3(3 * square, 0, 0);
  ASSERT_LT(min_cosine(grid, after), 0);
  const RepairedSurface repaired = repaired_between(grid, after);
  EXPECT_EQ(repaired.misoriented_faces, 0u);
  EXPECT_GT(min_cosine(grid, repaired.vertices), 0);
  // The neighbours all moved by the shift, so their harmonic mean is the shift.
  EXPECT_TRUE(repaired.vertices.isApprox(Points(grid.vertices.colwise() + shift), 1e-6));
  EXPECT_GT(repaired.repaired_vertices, 0u);
  EXPECT_LT(repaired.repaired_vertices, 60u);
}

TEST(RepairMisorientedFaces, ResetsWhatWasStretchedOrCompressedTooFar) {
  const TriangleMesh grid = shapes::square_grid(side);
  const int drawn = vertex_at(grid, 0.5, 0.5);
  // Up: edges grow. Aside, nearly onto an edge beyond: faces shrink, and none turns.
  for (const Vector3& way : {Vector3(0, 0, 1), Vector3(0.97, 0, 0)}) {
    Points after = grid.vertices;
    after.col(drawn) += square * way;
    const auto released = [&](double max_stretch) {
      FaceRepairSettings settings;
      settings.max_degrees = 180;
      settings.max_stretch = max_stretch;
      return repaired_between(grid, after, settings);
    };
    const RepairedSurface repaired = released(1.3);
    EXPECT_TRUE(repaired.vertices.isApprox(grid.vertices, 1e-6));
    EXPECT_TRUE(
        std::binary_search(repaired.stretched_vertices.begin(), repaired.stretched_vertices.end(), drawn));
    EXPECT_LE(repaired.stretched_vertices.size(), repaired.repaired_vertices);
    EXPECT_EQ(released(1000).vertices, after);
    EXPECT_TRUE(released(1000).stretched_vertices.empty());
  }
}

// Each side of the ridge turned by less than the limit, but the two are folded onto each other.
TEST(RepairMisorientedFaces, ResetsAFoldThatTheShapeDoesNotHave) {
  const TriangleMesh grid = shapes::square_grid(side);
  const auto with_ridge = [&](double degrees) {
    Points after = grid.vertices;
    const double height = square * std::tan(degrees * std::numbers::pi / 180);
    for (int k = 4; k <= 8; ++k) after(2, vertex_at(grid, 0.5, k * square)) = height;
    return after;
  };
  const Points folded = with_ridge(50), bent = with_ridge(40);
  EXPECT_GT(repaired_between(grid, folded).repaired_vertices, 0u);
  EXPECT_LT(repaired_between(grid, folded).vertices.row(2).maxCoeff(), 0.5 * folded.row(2).maxCoeff());
  EXPECT_EQ(repaired_between(grid, bent).vertices, bent);
  EXPECT_EQ(repair_misoriented_faces({folded, grid, folded}).vertices, folded);
}

TEST(RepairMisorientedFaces, LeavesNoMisorientedFaceInAFoldedPatch) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> shift(-1, 1);
  const TriangleMesh grid = shapes::square_grid(4 * side);
  for (int trial = 0; trial < 20; ++trial) {
    Points after = grid.vertices;
    for (auto&& x : after.colwise())
      if ((x - Vector3(0.5, 0.5, 0)).norm() < 0.75 * square)
        x += square * Vector3(shift(random), shift(random), 2 * shift(random));
    ASSERT_LT(min_cosine(grid, after), 0);
    const RepairedSurface repaired = repaired_between(grid, after);
    EXPECT_EQ(repaired.misoriented_faces, 0u);
    EXPECT_GT(min_cosine(grid, repaired.vertices), 0);
  }
}

TEST(RepairMisorientedFaces, LeavesWhatWasFoldedSmoothAndRestoresWhatWasFolded) {
  const TriangleMesh smooth = shapes::square_grid(side);
  TriangleMesh folded = smooth;
  folded.vertices.col(vertex_at(smooth, 0.5, 0.5)) += Vector3(0, 0, 2.5 * square);
  const double limit = std::cos(FaceRepairSettings{}.max_degrees * std::numbers::pi / 180);
  ASSERT_LT(min_cosine(smooth, folded.vertices), limit);
  EXPECT_EQ(repaired_between(folded, smooth.vertices).vertices, smooth.vertices);
  EXPECT_TRUE(repaired_between(smooth, folded.vertices).vertices.isApprox(smooth.vertices, 1e-6));
}

TEST(RepairMisorientedFaces, ReleasesNoMoreRingsThanHelp) {
  // Tilted up to the limit all over, so that what the neighbours do hardly helps.
  const double tilt = (FaceRepairSettings{}.max_degrees - 1) * std::numbers::pi / 180;
  const Matrix3 turn = Eigen::AngleAxisd(tilt, Vector3::UnitX()).toRotationMatrix();
  std::mt19937 random(11);
  std::uniform_real_distribution<double> shift(-0.4, 0.4);
  int stubborn = 0;
  for (int trial = 0; trial < 20; ++trial) {
    TriangleMesh before = shapes::square_grid(4 * side);
    for (auto&& x : before.vertices.colwise())
      x += square / 4 * Vector3(shift(random), shift(random), shift(random));
    Points after = turn * before.vertices;
    after.col(vertex_at(before, 0.5, 0.5)) += Vector3(0, square, 0);
    const RepairedSurface all = repaired_between(before, after);
    stubborn += all.misoriented_faces > 0 ? 1 : 0;
    for (int most = 1; most < FaceRepairSettings{}.max_rings; ++most) {
      FaceRepairSettings settings;
      settings.max_rings = most;
      const RepairedSurface fewer = repaired_between(before, after, settings);
      EXPECT_LE(all.misoriented_faces, fewer.misoriented_faces);
      if (all.misoriented_faces == fewer.misoriented_faces) {
        EXPECT_LE(all.repaired_vertices, fewer.repaired_vertices);
      }
    }
  }
  EXPECT_GT(stubborn, 0);
}

TEST(RepairMisorientedFaces, LeavesTheFitWhereMostOfItTurned) {
  const TriangleMesh grid = shapes::square_grid(4 * side);
  Points after = grid.vertices;
  after.topRows(1) = 1 - after.topRows(1).array();  // a mirror image: every face has turned
  const RepairedSurface repaired = repaired_between(grid, after);
  EXPECT_EQ(repaired.vertices, after);
  EXPECT_EQ(repaired.repaired_vertices, 0u);
  EXPECT_EQ(repaired.misoriented_faces, static_cast<std::size_t>(grid.faces.cols()));
}

TEST(RepairMisorientedFaces, ResetsOnlyWhatTurnedFartherThanItsLimit) {
  const TriangleMesh two = shapes::joined(shapes::square_grid(2), shapes::square_grid(2));
  for (const double beyond : {-1.0, 1.0}) {
    const double angle = (FaceRepairSettings{}.max_degrees + beyond) * std::numbers::pi / 180;
    Points after = two.vertices;
    const Matrix3 turn = Eigen::AngleAxisd(angle, Vector3::UnitX()).toRotationMatrix();
    after.leftCols(9) = turn * two.vertices.leftCols(9);
    EXPECT_EQ(repaired_between(two, after).repaired_vertices, beyond > 0 ? 9u : 0u);
  }
}

TEST(RepairMisorientedFaces, LeavesNoMisorientedFaceWhereShortEdgesMeetLongOnes) {
  TriangleMesh grid = shapes::square_grid(2 * side);
  for (auto&& x : grid.vertices.colwise()) x.head<2>() = x.head<2>().array().cube();
  Points after = grid.vertices;
  for (auto&& x : after.colwise()) x += Vector3(0.4 * x[0], -0.3 * x[1], 0.2 * x[0] * x[0]);
  const int drawn = vertex_at(grid, 0.125, 0.125);
  after.col(drawn) += Vector3(0.1, 0.1, 0);
  ASSERT_LT(min_cosine(grid, after), 0);
  const RepairedSurface repaired = repaired_between(grid, after);
  EXPECT_EQ(repaired.misoriented_faces, 0u);
  EXPECT_GT(min_cosine(grid, repaired.vertices), 0);
}

TEST(RepairMisorientedFaces, MovesNothingFarFromMisorientedFaces) {
  const TriangleMesh grid = shapes::square_grid(side);
  Points after = grid.vertices;
  for (auto&& x : after.colwise()) x += Vector3(0, 0, 0.3 * x[0] * x[1]);
  const int drawn = vertex_at(grid, 0.25, 0.25);
  after.col(drawn) += Vector3(2 * square, 2 * square, 0);
  const RepairedSurface repaired = repaired_between(grid, after);
  ASSERT_GT(repaired.repaired_vertices, 0u);
  for (Eigen::Index i = 0; i < after.cols(); ++i)
    if ((grid.vertices.col(i) - grid.vertices.col(drawn)).norm() > 10 * square) {
      EXPECT_EQ(repaired.vertices.col(i), after.col(i));
    }
}

TEST(RepairMisorientedFaces, ReportsWhatNoNeighboursCanReset) {
  // All of it was turned, so that nobody remains to follow.
  const TriangleMesh single = shapes::triangle();
  Points after = single.vertices;
  after.col(0).swap(after.col(1));
  const RepairedSurface repaired = repaired_between(single, after);
  EXPECT_TRUE(repaired.vertices.allFinite());
  EXPECT_EQ(repaired.repaired_vertices, 3u);
  EXPECT_EQ(repaired.misoriented_faces, min_cosine(single, repaired.vertices) < 0 ? 1u : 0u);
}

TEST(RepairMisorientedFaces, TakesFacesWithoutAreaAndLooseVertices) {
  TriangleMesh mesh = shapes::square_grid(side);
  mesh.vertices.conservativeResize(3, mesh.vertices.cols() + 1);
  mesh.vertices.rightCols(1) = Vector3(5, 5, 5);
  mesh.faces.conservativeResize(3, mesh.faces.cols() + 1);
  mesh.faces.rightCols(1) << 0, 0, 1;
  const RepairedSurface repaired = repaired_between(mesh, mesh.vertices);
  EXPECT_EQ(repaired.vertices, mesh.vertices);
  EXPECT_EQ(repaired.repaired_vertices, 0u);
}

TEST(RepairMisorientedFaces, LeavesAPocketThatWasInsideOutBefore) {
  const TriangleMesh grid = shapes::square_grid(2 * side);
  const Vector3 middle(0.5, 0.5, 0);
  const Points in = with_pocket(grid, middle, 0.2), out = with_pocket(grid, middle, -0.2);
  const TriangleMesh turned_out{out, grid.faces};
  const RepairedSurface left = repair_misoriented_faces({in, turned_out, in});
  EXPECT_EQ(left.vertices, in);
  EXPECT_EQ(left.repaired_vertices, 0u);
  EXPECT_GT(left.misoriented_faces, 0u);
  // Of a bump the same is a fold.
  const RepairedSurface of_a_bump = repair_misoriented_faces({out, turned_out, in});
  EXPECT_GT(of_a_bump.repaired_vertices, 0u);
  EXPECT_LT(of_a_bump.misoriented_faces, left.misoriented_faces);
}

TEST(RepairMisorientedFaces, JudgesEveryPatchOnItsOwnAndInAnyPlace) {
  const TriangleMesh grid = shapes::square_grid(4 * side);
  const Vector3 one(0.25, 0.25, 0), two(0.75, 0.75, 0);
  const Matrix3 turn = Eigen::AngleAxisd(2, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  const auto pockets = [&](double first, double second) {
    return with_pocket({with_pocket(grid, one, first), grid.faces}, two, second);
  };
  // Both flip since: the first into its shape, the second out of it.
  const Points shape = pockets(0.2, 0.2);
  const TriangleMesh before{turn * pockets(-0.2, 0.2), grid.faces};
  const Points after = turn * pockets(0.2, -0.2);
  FaceRepairSettings settings;
  settings.max_released = 0.5;
  const RepairedSurface repaired = repair_misoriented_faces({shape, before, after}, settings);
  ASSERT_GT(repaired.repaired_vertices, 0u);
  for (Eigen::Index i = 0; i < after.cols(); ++i)
    if ((grid.vertices.col(i) - one).norm() < 0.3) {
      EXPECT_EQ(repaired.vertices.col(i), after.col(i));
    }
  const auto error = [&](const Points& vertices) { return (vertices - turn * shape).norm(); };
  EXPECT_LT(error(repaired.vertices), 0.2 * error(after));
}

TEST(RepairMisorientedFaces, BendsNothingFartherFromItsShape) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> shift(-1, 1);
  const TriangleMesh grid = shapes::square_grid(2 * side);
  const auto folded = [&](double max_shift) {
    Points vertices = grid.vertices;
    for (auto&& x : vertices.colwise())
      if ((x - Vector3(0.5, 0.5, 0)).norm() < 0.2)
        x += max_shift * square * Vector3(shift(random), shift(random), shift(random));
    return vertices;
  };
  const std::vector<Hinge> edges = hinges(grid);
  const auto bent = [&](const Points& vertices) {
    const std::vector<double> all = bends(edges, grid.faces, grid.vertices, vertices);
    return std::inner_product(all.begin(), all.end(), all.begin(), 0.0);
  };
  FaceRepairSettings settings;
  settings.released_at_least = 1000;
  int left = 0, repairs = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const TriangleMesh before{folded(trial % 2 == 0 ? 1 : 0.2), grid.faces};
    const Points after = folded(trial % 2 == 0 ? 0.2 : 1);
    const RepairedSurface repaired = repair_misoriented_faces({grid.vertices, before, after}, settings);
    EXPECT_LE(bent(repaired.vertices), bent(after));
    left += repaired.repaired_vertices == 0 && repaired.misoriented_faces > 0 ? 1 : 0;
    repairs += repaired.repaired_vertices > 0 ? 1 : 0;
  }
  EXPECT_GT(left, 0);
  EXPECT_GT(repairs, 0);
}

TEST(Bends, AreAnglesBetweenFacesAgainstTheShapeInAnyPlace) {
  TriangleMesh roof = shapes::square_grid(1);
  const std::vector<Hinge> ridge = hinges(roof);
  ASSERT_EQ(ridge.size(), 1u);
  const Vector3 from = roof.vertices.col(ridge[0].a), to = roof.vertices.col(ridge[0].b);
  const Matrix3 turn = Eigen::AngleAxisd(2, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  // The two faces, the second turned about the edge between them.
  const auto opened = [&](double angle) {
    Points vertices = roof.vertices;
    const Matrix3 about = Eigen::AngleAxisd(angle, (to - from).normalized()).toRotationMatrix();
    for (const int vertex : roof.faces.col(ridge[0].second))
      vertices.col(vertex) = from + about * (vertices.col(vertex) - from);
    return vertices;
  };
  for (const double shape : {-2.5, -1.0, 0.0, 2.0})
    for (const double angle : {-3.0, -0.5, 0.0, 1.0, 2.9}) {
      const Points placed = (2 * turn * opened(angle)).colwise() + Vector3(1, 2, 3);
      EXPECT_NEAR(std::abs(bends(ridge, roof.faces, opened(shape), placed)[0]),
                  std::abs(std::remainder(angle - shape, 2 * std::numbers::pi)), 1e-12);
    }
}

}  // namespace
}  // namespace bespoke
