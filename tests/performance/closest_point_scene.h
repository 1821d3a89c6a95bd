#pragma once

#include <algorithm>
#include <filesystem>
#include <random>

#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/product/mesh_io.h"
#include "support/shapes.h"

namespace bespoke::closest_points {

/// Body d01 where the shared cases are present, else a sphere of as many faces.
struct Scene {
  TriangleMesh target;
  Points queries;  ///< as many as the source has vertices
  Points normals;  ///< at the queries
};

/// `distance`: of the queries from the surface, as a fraction of the target's diagonal.
inline Scene scene(double distance) {
  const std::filesystem::path body = std::filesystem::path(BESPOKE_SHARED_DIR) / "cases" / "d01_body_dress";
  const bool present = std::filesystem::exists(body / "reference_b.obj");
  Scene result;
  result.target = present ? read_triangle_mesh(body / "reference_b.obj") : shapes::icosphere(6);
  const TriangleMesh& mesh = result.target;
  const Points normals = face_normals(mesh);
  const double extent = diagonal(mesh.vertices);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Eigen::Index count = std::min<Eigen::Index>(13380, mesh.faces.cols());
  result.queries.resize(3, count);
  result.normals.resize(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index face = i * mesh.faces.cols() / count;
    result.normals.col(i) = normals.col(face);
    result.queries.col(i) = mesh.vertices.col(mesh.faces(0, face)) +
                            distance * extent * Vector3(uniform(random), uniform(random), uniform(random));
  }
  return result;
}

}  // namespace bespoke::closest_points
