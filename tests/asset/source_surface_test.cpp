#include "bespoke/asset/source_surface.h"

#include <gtest/gtest.h>

#include "asset/small_asset.h"
#include "bespoke/error.h"

namespace bespoke {
namespace {

TEST(SourceSurface, IsThatOfAClosedSource) {
  const Vector3 centre(0.3, -0.2, 0.1);
  const TriangleMesh source = test::sphere(centre, 0.8, 4);
  const TriangleMesh surface = source_surface(with_preview(test::small_asset(), source));
  const double voxel = diagonal(source.vertices) / 128;
  const Eigen::VectorXd radii = (surface.vertices.colwise() - centre).colwise().norm();
  EXPECT_NEAR(radii.minCoeff(), 0.8, 0.25 * voxel);
  EXPECT_NEAR(radii.maxCoeff(), 0.8, 0.25 * voxel);
  const MeshFindings findings = inspect_mesh(surface);
  EXPECT_GT(findings.faces, 5000u);
  EXPECT_EQ(findings.components, 1u);
  EXPECT_EQ(findings.boundary_edges, 0u);
  EXPECT_EQ(findings.inconsistent_edges, 0u);
  // Outward: faces see the centre from behind.
  const Points normals = face_normals(surface);
  for (Eigen::Index i = 0; i < surface.faces.cols(); ++i)
    EXPECT_GT(normals.col(i).dot(surface.vertices.col(surface.faces(0, i)) - centre), 0);
}

TEST(SourceSurface, IsAShellAroundAnOpenSource) {
  const TriangleMesh source = shapes::square_grid(8);
  const TriangleMesh surface = source_surface(with_preview(test::small_asset(), source));
  const double voxel = diagonal(source.vertices) / 128;
  EXPECT_EQ(inspect_mesh(surface).boundary_edges, 0u);
  EXPECT_NEAR(surface.vertices.row(2).maxCoeff(), voxel, 0.5 * voxel);
  EXPECT_NEAR(surface.vertices.row(2).minCoeff(), -voxel, 0.5 * voxel);
}

TEST(SourceSurface, NeedsPreviews) { EXPECT_THROW(source_surface(test::small_asset()), InvalidInput); }

}  // namespace
}  // namespace bespoke
