#include "bespoke/cloud/detail/surface_net.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bespoke/lattice/leaf_table.h"

namespace bespoke {
namespace {

/// The leaves from −size to size − 1 along each axis, with the values of a function of the place.
template <class Value>
SparseField field_of(int size, double cell, const Value& value) {
  SparseField field{Vector3::Zero(), cell, {}, {}};
  for (int i = -size; i < size; ++i)
    for (int j = -size; j < size; ++j)
      for (int k = -size; k < size; ++k) field.leaves.push_back({i, j, k});
  for (const LeafCoordinates& leaf : field.leaves)
    for (int number = 0; number < leaf_nodes; ++number)
      field.values.push_back(
          static_cast<float>(value(field.place(moved(first_node(leaf), place_of_number(number))))));
  return field;
}

const auto where_it_starts = [](const Vector3& start) { return std::optional(start); };
const auto sphere = [](const Vector3& x) { return x.norm() - 1; };

double volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& face : mesh.faces.colwise())
    sum += mesh.vertices.col(face[0]).dot(mesh.vertices.col(face[1]).cross(mesh.vertices.col(face[2]))) / 6;
  return sum;
}

TEST(SurfaceNet, OfAPlaneIsThePlane) {
  const TriangleMesh mesh = surface_net(
      field_of(1, 0.125, [](const Vector3& x) { return x.x() - 0.5 * x.z() - 0.01; }), where_it_starts);
  EXPECT_EQ(inspect_mesh(mesh).components, 1u);
  for (const auto& v : mesh.vertices.colwise()) EXPECT_NEAR(v.x() - 0.5 * v.z(), 0.01, 1e-7);
  const Points normals = face_normals(mesh);
  for (const auto& normal : normals.colwise())
    EXPECT_NEAR(normal.dot(Vector3(1, 0, -0.5).normalized()), 1, 1e-6);
}

TEST(SurfaceNet, OfABallIsClosedAndFacesOutwardsAcrossLeaves) {
  const TriangleMesh mesh = surface_net(field_of(2, 0.1, sphere), where_it_starts);
  const MeshFindings found = inspect_mesh(mesh);
  EXPECT_EQ(found.components, 1u);
  EXPECT_EQ(found.boundary_edges + found.non_manifold_edges + found.inconsistent_edges, 0u);
  EXPECT_EQ(found.unreferenced_vertices, 0u);
  EXPECT_EQ(2 * found.vertices, found.faces + 4) << "of a sphere, by Euler";
  EXPECT_NEAR(volume(mesh), 4.18879, 0.03 * 4.18879);
}

// Where sheets come near to each other a cell has several vertices.
TEST(SurfaceNet, IsManifoldWhereSheetsPassThroughOneCell) {
  const auto thin = [](const Vector3& x) {
    return std::max(std::abs(x.x() + 0.7 * x.y()) - 0.06, x.norm() - 1);
  };
  const MeshFindings found = inspect_mesh(surface_net(field_of(2, 0.1, thin), where_it_starts));
  EXPECT_GT(found.faces, 100u);
  EXPECT_EQ(found.non_manifold_edges, 0u);
  EXPECT_EQ(found.inconsistent_edges, 0u);
}

TEST(SurfaceNet, EndsWhereValuesOrPlacesLack) {
  const std::size_t all = inspect_mesh(surface_net(field_of(2, 0.1, sphere), where_it_starts)).faces;
  const auto half_known = [](const Vector3& x) {
    return x.z() > 0.05 ? sphere(x) : std::numeric_limits<double>::quiet_NaN();
  };
  const TriangleMesh half = surface_net(field_of(2, 0.1, half_known), where_it_starts);
  EXPECT_GT(inspect_mesh(half).boundary_edges, 30u);
  EXPECT_GE(half.vertices.row(2).minCoeff(), 0.05);
  const TriangleMesh capless =
      surface_net(field_of(2, 0.1, sphere), [](const Vector3& start) -> std::optional<Vector3> {
        return start.z() < 0.9 ? std::optional(start) : std::nullopt;
      });
  EXPECT_GT(inspect_mesh(capless).boundary_edges, 10u);
  EXPECT_EQ(inspect_mesh(capless).components, 1u);
  EXPECT_LT(inspect_mesh(capless).faces, all);
  EXPECT_LT(capless.vertices.row(2).maxCoeff(), 0.9);
}

TEST(SurfaceNet, OfOneSignIsEmpty) {
  const TriangleMesh mesh = surface_net(field_of(1, 1, [](const Vector3&) { return 1; }), where_it_starts);
  EXPECT_EQ(mesh.vertices.cols(), 0);
  EXPECT_EQ(mesh.faces.cols(), 0);
}

}  // namespace
}  // namespace bespoke
