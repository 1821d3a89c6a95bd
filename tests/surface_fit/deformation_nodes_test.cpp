#include "bespoke/surface_fit/graph/deformation_nodes.h"

#include <gtest/gtest.h>

#include <numbers>

#include "support/shapes.h"

namespace bespoke {
namespace {

TEST(DeformationNodes, CoverTheSurfaceSparsely) {
  const TriangleMesh sphere = shapes::icosphere(4);
  const DeformationNodes nodes = make_deformation_nodes(sphere, 0.3);
  for (int a = 0; a < nodes.size(); ++a)
    for (int b = 0; b < a; ++b) EXPECT_GT((nodes.rest.col(a) - nodes.rest.col(b)).norm(), 0.3 * 0.8);
  for (const auto& vertex : sphere.vertices.colwise())
    EXPECT_LT((nodes.rest.colwise() - vertex).colwise().norm().minCoeff(), 0.3);
  EXPECT_NEAR(nodes.areas.sum(), 1, 1e-12);
  EXPECT_NEAR((nodes.vertex_weights.colwise().sum().array() - 1).abs().maxCoeff(), 0, 1e-12);
}

TEST(DeformationNodes, ReproduceTranslationsExactlyAndTurnsAlongTheSurfaceNearly) {
  const TriangleMesh square = shapes::square_grid(30);
  const DeformationNodes nodes = make_deformation_nodes(square, 0.15);
  const Points shift = Vector3(1, -2, 3).replicate(1, nodes.size());
  Matrix3 linear;
  linear << 0.1, 0.4, 7, -0.3, 0.2, 7, 0.5, -0.6, 7;
  for (Eigen::Index i = 0; i < square.vertices.cols(); ++i) {
    EXPECT_LT((nodes.displacement(shift, i) - Vector3(1, -2, 3)).norm(), 1e-12);
    EXPECT_LT((nodes.displacement(linear * nodes.rest, i) - linear * square.vertices.col(i)).norm(), 0.02);
  }
}

TEST(DeformationNodes, SpacingGivesNotMoreThanTheCountAskedForAndEnoughToCover) {
  const TriangleMesh sphere = shapes::icosphere(5);
  const double area = vertex_areas(sphere).sum();
  for (const int count : {100, 400}) {
    const double spacing = node_spacing(area, count);
    const int size = make_deformation_nodes(sphere, spacing).size();
    EXPECT_LE(size, count);
    EXPECT_GE(size, area / (std::numbers::pi * spacing * spacing));  // discs of this radius cover the sphere
  }
}

TEST(DeformationNodes, CombineAtAPointLikeItsCorners) {
  const TriangleMesh sphere = shapes::icosphere(3);
  const DeformationNodes nodes = make_deformation_nodes(sphere, 0.4);
  const Points displacements = nodes.rest.array().square().matrix();
  SurfacePoint point;
  point.face = 17;
  point.barycentric = Vector3(0.2, 0.3, 0.5);
  Vector3 expected = Vector3::Zero(), found = Vector3::Zero();
  for (int k = 0; k < 3; ++k)
    expected += point.barycentric[k] * nodes.displacement(displacements, sphere.faces(k, point.face));
  const auto combination = nodes.at_point(point, sphere.faces);
  for (std::size_t i = 0; i < combination.size(); ++i) {
    found += combination[i].weight * displacements.col(combination[i].node);
    if (i > 0) {
      EXPECT_LT(combination[i - 1].node, combination[i].node);
    }
  }
  EXPECT_TRUE(found.isApprox(expected, 1e-12));
}

TEST(DeformationNodes, NeighboursAreMutualAndEnough) {
  const DeformationNodes nodes = make_deformation_nodes(shapes::icosphere(4), 0.25);
  for (int node = 0; node < nodes.size(); ++node) {
    EXPECT_GE(nodes.neighbours[node].size(), 6u);
    for (const int other : nodes.neighbours[node]) {
      const auto& back = nodes.neighbours[other];
      EXPECT_TRUE(std::find(back.begin(), back.end(), node) != back.end());
    }
  }
}

TEST(DeformationNodes, TiePiecesTogetherAndTakeLooseVerticesAlong) {
  TriangleMesh pieces = shapes::joined(
      shapes::icosphere(3), shapes::moved(shapes::icosphere(3), {Matrix3::Identity(), Vector3(5, 0, 0)}));
  pieces = shapes::joined(pieces,
                          shapes::moved(shapes::triangle(), {1e-3 * Matrix3::Identity(), Vector3(2, 0, 0)}));
  pieces.vertices.conservativeResize(3, pieces.vertices.cols() + 1);
  pieces.vertices.rightCols(1) = Vector3(0, 9, 0);
  const DeformationNodes nodes = make_deformation_nodes(pieces, 0.4);
  std::vector<char> reached(static_cast<std::size_t>(nodes.size()), 0);
  std::vector<int> open{0};
  reached[0] = 1;
  while (!open.empty()) {
    const int node = open.back();
    open.pop_back();
    for (const int other : nodes.neighbours[node])
      if (!reached[other]) {
        reached[other] = 1;
        open.push_back(other);
      }
  }
  EXPECT_EQ(std::count(reached.begin(), reached.end(), 1), nodes.size());
  const Points shift = Vector3(1, 2, 3).replicate(1, nodes.size());
  EXPECT_LT((nodes.displacement(shift, pieces.vertices.cols() - 1) - Vector3(1, 2, 3)).norm(), 1e-12);
}

TEST(DeformationNodes, WorkOnATriangleAndOnASoup) {
  EXPECT_GE(make_deformation_nodes(shapes::triangle(), 0.1).size(), 1);
  EXPECT_EQ(make_deformation_nodes(shapes::triangle(), 10).size(), 1);
  TriangleMesh soup;
  const TriangleMesh sphere = shapes::icosphere(3);
  soup.vertices.resize(3, 3 * sphere.faces.cols());
  soup.faces.resize(3, sphere.faces.cols());
  for (Eigen::Index f = 0; f < sphere.faces.cols(); ++f)
    for (int k = 0; k < 3; ++k) {
      soup.vertices.col(3 * f + k) = sphere.vertices.col(sphere.faces(k, f));
      soup.faces(k, f) = static_cast<int>(3 * f + k);
    }
  const DeformationNodes nodes = make_deformation_nodes(soup, 0.4);
  EXPECT_LT(nodes.size(), 200);
  EXPECT_GT(nodes.size(), 40);
}

TEST(BendingStencils, IgnoreAffineDisplacementsOfTheGivenPlacesAndSeeOthers) {
  const DeformationNodes nodes = make_deformation_nodes(shapes::icosphere(4), 0.3);
  Matrix3 linear;
  linear << 0.3, 0.1, -0.4, 0.2, 0.5, 0.1, -0.2, 0.3, 0.6;
  const Points places = nodes.rest + 0.3 * nodes.rest.array().square().matrix();
  const Points affine = (linear * places).colwise() + Vector3(1, 2, 3);
  const Points bent = places.array().square().matrix();
  const auto energy = [&](const Points& displacements) {
    double sum = 0;
    for (const BendingStencil& stencil : bending_stencils(nodes, places)) {
      const Points local = displacements(Eigen::all, stencil.ids);
      sum += (local * stencil.quadratic * local.transpose()).trace();
    }
    return sum / nodes.size();
  };
  const double scale = nodes.spacing * nodes.spacing;
  EXPECT_LT(energy(affine), 1e-2 * scale);
  EXPECT_GT(energy(affine), -1e-12);
  EXPECT_GT(energy(bent), 3e-3 * scale);
  EXPECT_LT(energy(Vector3(4, 5, 6).replicate(1, nodes.size())), 1e-12);
}

}  // namespace
}  // namespace bespoke
