#include "bespoke/pattern/detail/seam_lines.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "bespoke/mesh/mesh_edges.h"
#include "bespoke/pattern/flat_pattern.h"
#include "pattern/tubes.h"
#include "support/error_message.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using ::testing::HasSubstr;

double area_of(const TriangleMesh& mesh) {
  double area = 0;
  for (const auto& face : mesh.faces.colwise()) {
    const Vector3 a = mesh.vertices.col(face[0]);
    area +=
        (mesh.vertices.col(face[1]) - a).head<3>().cross((mesh.vertices.col(face[2]) - a).head<3>()).norm() /
        2;
  }
  return area;
}

/// A square of 4 × 4 cells of 100 mm; vertices 5 r + c.
Garment square() {
  TriangleMesh mesh = shapes::square_grid(4);
  mesh.vertices *= 400 / (mesh.vertices.rowwise().maxCoeff() - mesh.vertices.rowwise().minCoeff()).maxCoeff();
  return test::garment_of(std::move(mesh));
}

/// The line where a plane n · x = d crosses the edges of a mesh, in order along `way`.
SeamCut plane_cut(const TriangleMesh& mesh, const Vector3& normal, double offset, const Vector3& way) {
  std::vector<std::pair<double, EdgePoint>> points;
  for (const MeshEdge& edge : mesh_edges(mesh).edges) {
    const double a = normal.dot(mesh.vertices.col(edge.a)) - offset,
                 b = normal.dot(mesh.vertices.col(edge.b)) - offset;
    if (!(a * b < 0)) continue;
    const double share = a / (a - b);
    const Vector3 at =
        mesh.vertices.col(edge.a) + share * (mesh.vertices.col(edge.b) - mesh.vertices.col(edge.a));
    points.push_back({way.dot(at), {edge.a, edge.b, share}});
  }
  std::sort(points.begin(), points.end(), [](const auto& p, const auto& q) { return p.first < q.first; });
  SeamCut cut;
  for (const auto& [along, point] : points) cut.line.push_back(point);
  return cut;
}

/// Two lines across the square, which cross inside a face.
SeamFile cross() {
  const TriangleMesh mesh = square().mesh;
  const Vector3 middle = mesh.vertices.rowwise().mean();
  const Vector3 one = Vector3(1, 0.3, 0).normalized(), other = Vector3(-0.2, 1, 0).normalized();
  return {{plane_cut(mesh, one, one.dot(middle) + 13, {0, 1, 0}),
           plane_cut(mesh, other, other.dot(middle) + 7, {1, 0, 0})},
          {},
          {}};
}

TEST(FacesAlongLines, KeepTheSurface) {
  const Garment garment = square();
  const FacesAlongLines cut = faces_along_lines(garment, cross());
  const Garment finer = cut_along(garment, cut);
  EXPECT_NEAR(area_of(finer.mesh), area_of(garment.mesh), 1e-6);
  for (const auto& face : finer.mesh.faces.colwise()) {
    const Vector3 a = finer.mesh.vertices.col(face[0]), b = finer.mesh.vertices.col(face[1]);
    EXPECT_GT((b - a).cross(Vector3(finer.mesh.vertices.col(face[2])) - a).z(), 0);
  }
  // No hanging vertices: the boundary is as long as before.
  const auto boundary = [](const TriangleMesh& mesh) {
    double length = 0;
    for (const MeshEdge& edge : mesh_edges(mesh).edges)
      if (edge.on_boundary()) length += (mesh.vertices.col(edge.a) - mesh.vertices.col(edge.b)).norm();
    return length;
  };
  EXPECT_NEAR(boundary(finer.mesh), boundary(garment.mesh), 1e-6);
}

TEST(FacesAlongLines, LinesThatCrossMakeFourPieces) {
  PatternOptions options;
  options.cut.seams = cross();
  const FlatPattern pattern = flat_pattern(square(), nullptr, options);
  ASSERT_EQ(pattern.pieces.size(), 4u);
  EXPECT_EQ(pattern.seams.size(), 4u);
  for (const PatternPiece& piece : pattern.pieces) EXPECT_NEAR(piece.strain.max, 1, 1e-6);
  for (const PatternSeam& seam : pattern.seams) EXPECT_NEAR(seam.lengths[0], seam.lengths[1], 1e-4);
}

// A straight line up a tube of planar sides: its two halves are rectangles, whatever the triangles are.
TEST(FacesAlongLines, CutATubeIntoRectangles) {
  const int sides = 24;
  const double radius = 100, height = 300;
  const Garment tube = test::garment_of(test::tube(sides, 5, radius, height));
  PatternOptions options;
  options.cut.seams.emplace();
  for (const double side : {-1.0, 1.0}) {
    SeamCut cut = plane_cut(tube.mesh, {0, 0, 1}, 3, {0, 1, 0});
    std::erase_if(cut.line, [&](const EdgePoint& p) {
      return side * (tube.mesh.vertices(0, p.a) + tube.mesh.vertices(0, p.b)) < 0;
    });
    options.cut.seams->cuts.push_back(cut);
  }
  const FlatPattern pattern = flat_pattern(tube, nullptr, options);
  ASSERT_EQ(pattern.pieces.size(), 2u);
  double width = 0;
  for (const PatternPiece& piece : pattern.pieces) {
    const Eigen::Vector2d size = piece.flat.rowwise().maxCoeff() - piece.flat.rowwise().minCoeff();
    EXPECT_NEAR(size.y(), height, 1e-4);
    width += size.x();
  }
  EXPECT_NEAR(width, sides * test::side_of(sides, radius), 1e-3);
}

TEST(FacesAlongLines, RefuseLinesThatLeaveTheFaces) {
  SeamFile far{{{{}, {{0, 0, 0}, {24, 24, 0}}, 0, {}}}, {}, {}};
  EXPECT_THAT(test::error_message<InvalidInput>([&] { faces_along_lines(square(), far); }),
              HasSubstr("points 1 and 2 of its line lie in no common face"));
  SeamFile no_edge{{{{}, {{0, 24, 0.5}, {0, 0, 0}}, 0, {}}}, {}, {}};
  EXPECT_THAT(test::error_message<InvalidInput>([&] { faces_along_lines(square(), no_edge); }),
              HasSubstr("no edge joins vertices 1 and 25"));
}

}  // namespace
}  // namespace bespoke
