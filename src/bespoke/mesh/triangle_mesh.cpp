#include "bespoke/mesh/triangle_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/mesh/disjoint_sets.h"
#include "bespoke/mesh/equal_positions.h"
#include "bespoke/mesh/mesh_edges.h"
#include "bespoke/parallel.h"
#include "bespoke/sha256.h"

namespace bespoke {
namespace {

// Below this share of the squared longest edge, twice the area is rounding noise of the cross product.
constexpr double relative_area_noise = 1e-14;

/// In parallel: visit(face) may write what is that face's alone.
template <class Visit>
void for_each_face(const TriangleMesh& mesh, const Visit& visit) {
  constexpr std::size_t grain = 1024;
  parallel_for(static_cast<std::size_t>(mesh.faces.cols()), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t face = begin; face < end; ++face) visit(static_cast<Eigen::Index>(face));
  });
}

std::size_t count_components(const TriangleMesh& mesh, const std::vector<char>& referenced) {
  DisjointSets sets(static_cast<int>(referenced.size()));
  auto components = static_cast<std::size_t>(std::count(referenced.begin(), referenced.end(), 1));
  for (const auto& face : mesh.faces.colwise())
    for (int corner = 1; corner < 3; ++corner) components -= sets.join(face[0], face[corner]) ? 1 : 0;
  return components;
}

std::size_t count_duplicates(const Points& vertices) {
  std::vector<int> finite;
  for (Eigen::Index i = 0; i < vertices.cols(); ++i)
    if (vertices.col(i).allFinite()) finite.push_back(static_cast<int>(i));
  const EqualPositions equal = equal_positions(vertices, std::move(finite));
  return equal.columns.size() - equal.groups();
}

// Twice the area as a vector.
Vector3 area_vector(const TriangleMesh& mesh, Eigen::Index face) {
  const Vector3 a = mesh.vertices.col(mesh.faces(0, face));
  const Vector3 ab = mesh.vertices.col(mesh.faces(1, face)) - a;
  const Vector3 ac = mesh.vertices.col(mesh.faces(2, face)) - a;
  return ab.cross(ac);
}

std::string counted(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + ' ' + (count == 1 ? one : many);
}

}  // namespace

MeshFindings inspect_mesh(const TriangleMesh& mesh) {
  const Eigen::Index vertices = mesh.vertices.cols();
  if (mesh.faces.size() > 0 && !(mesh.faces.minCoeff() >= 0 && mesh.faces.maxCoeff() < vertices))
    throw InvalidInput("a face names a vertex outside 0 … " + std::to_string(vertices - 1));
  MeshFindings findings;
  findings.vertices = static_cast<std::size_t>(vertices);
  findings.faces = static_cast<std::size_t>(mesh.faces.cols());
  std::vector<char> referenced(findings.vertices, 0);
  for (const int vertex : mesh.faces.reshaped()) referenced[static_cast<std::size_t>(vertex)] = 1;
  findings.unreferenced_vertices =
      static_cast<std::size_t>(std::count(referenced.begin(), referenced.end(), 0));
  findings.components = count_components(mesh, referenced);
  findings.duplicate_vertices = count_duplicates(mesh.vertices);
  for (const MeshEdge& edge : mesh_edges(mesh).edges) {
    findings.boundary_edges += edge.on_boundary();
    findings.non_manifold_edges += edge.faces() > 2;
    findings.inconsistent_edges += edge.forward > 1 || edge.backward > 1;
  }
  const double extent = diagonal(mesh.vertices);
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face)
    findings.degenerate_faces += !(area_vector(mesh, face).norm() / 2 > 1e-14 * extent * extent);
  return findings;
}

std::string to_string(const MeshFindings& findings) {
  std::string line = counted(findings.vertices, "vertex", "vertices") + ", " +
                     counted(findings.faces, "face", "faces") + ", " +
                     counted(findings.components, "component", "components");
  const auto add = [&](std::size_t count, const char* one, const char* many) {
    if (count > 0) line += ", " + counted(count, one, many);
  };
  if (findings.faces > 0 && findings.boundary_edges == 0) line += ", closed";
  add(findings.boundary_edges, "boundary edge", "boundary edges");
  add(findings.non_manifold_edges, "non-manifold edge", "non-manifold edges");
  add(findings.inconsistent_edges, "inconsistently oriented edge", "inconsistently oriented edges");
  add(findings.degenerate_faces, "face without area", "faces without area");
  add(findings.unreferenced_vertices, "vertex in no face", "vertices in no face");
  add(findings.duplicate_vertices, "duplicate vertex", "duplicate vertices");
  return line;
}

void require_valid(const TriangleMesh& mesh, const std::string& what) {
  const Eigen::Index vertices = mesh.vertices.cols();
  if (mesh.faces.cols() == 0) throw InvalidInput(what + " has no faces");
  for (Eigen::Index i = 0; i < vertices; ++i)
    if (!mesh.vertices.col(i).allFinite())
      throw InvalidInput(what + ": vertex " + std::to_string(i) + " has a coordinate that is not finite");
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face)
    for (const int vertex : mesh.faces.col(face))
      if (!(vertex >= 0 && vertex < vertices))
        throw InvalidInput(what + ": face " + std::to_string(face) + " names vertex " +
                           std::to_string(vertex) + " of " + std::to_string(vertices));
  const double extent = diagonal(mesh.vertices);
  if (!(extent > 0)) throw InvalidInput(what + ": all vertices lie at one point");
  if (!std::isfinite(extent)) throw InvalidInput(what + ": coordinates are too large to compute with");
}

Box bounding_box(const Points& points) {
  Box box;
  for (Eigen::Index i = 0; i < points.cols(); ++i) box.extend(points.col(i));
  return box;
}

double diagonal(const Points& points) {
  return points.cols() == 0 ? 0 : bounding_box(points).diagonal().norm();
}

std::vector<double> distances(const Points& from, const Points& to) {
  const Eigen::VectorXd lengths = (from - to).colwise().norm();
  return {lengths.begin(), lengths.end()};
}

Points face_normals(const TriangleMesh& mesh) {
  Points normals(3, mesh.faces.cols());
  for_each_face(mesh, [&](Eigen::Index face) {
    const auto corner = [&](int k) { return mesh.vertices.col(mesh.faces(k, face)); };
    const double longest =
        std::max({(corner(1) - corner(0)).squaredNorm(), (corner(2) - corner(1)).squaredNorm(),
                  (corner(0) - corner(2)).squaredNorm()});
    const Vector3 area = area_vector(mesh, face);
    if (area.norm() > relative_area_noise * longest)
      normals.col(face) = area.stableNormalized();
    else
      normals.col(face).setZero();
  });
  return normals;
}

Points vertex_normals(const TriangleMesh& mesh) { return vertex_normals(mesh, face_normals(mesh)); }

Points vertex_normals(const TriangleMesh& mesh, const Points& of_faces) {
  Points corner_angles = Points::Zero(3, mesh.faces.cols());
  for_each_face(mesh, [&](Eigen::Index face) {
    if (of_faces.col(face).isZero(0)) return;
    const Matrix3 corners = mesh.vertices(Eigen::all, mesh.faces.col(face));
    const Vector3 a = corners.col(1) - corners.col(0), b = corners.col(2) - corners.col(1);
    const Vector3 c = corners.col(0) - corners.col(2);
    const double twice_area = a.cross(b).norm();
    const double first = std::atan2(twice_area, -c.dot(a)), second = std::atan2(twice_area, -a.dot(b));
    corner_angles.col(face) << first, second, std::max(0.0, std::numbers::pi - first - second);
  });
  Points normals = Points::Zero(3, mesh.vertices.cols());
  Eigen::VectorXd angles = Eigen::VectorXd::Zero(mesh.vertices.cols());
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face)
    for (int k = 0; k < 3; ++k) {
      normals.col(mesh.faces(k, face)) += corner_angles(k, face) * of_faces.col(face);
      angles(mesh.faces(k, face)) += corner_angles(k, face);
    }
  // Faces that face each other cancel up to rounding, which must not pass for a direction.
  for (Eigen::Index vertex = 0; vertex < normals.cols(); ++vertex) {
    if (normals.col(vertex).norm() > 1e-12 * angles(vertex))
      normals.col(vertex).normalize();
    else
      normals.col(vertex).setZero();
  }
  return normals;
}

Eigen::VectorXd vertex_areas(const TriangleMesh& mesh) {
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(mesh.vertices.cols());
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    const double sixth = area_vector(mesh, face).norm() / 6;
    for (int k = 0; k < 3; ++k) areas[mesh.faces(k, face)] += sixth;
  }
  return areas;
}

double growth(const TriangleMesh& mesh, const Points& moved) {
  const double before = vertex_areas(mesh).sum(), after = vertex_areas({moved, mesh.faces}).sum();
  return before > 0 && after > 0 ? std::sqrt(after / before) : 1;
}

std::string content_hash(const TriangleMesh& mesh) {
  static_assert(sizeof(int) == 4);
  const std::int64_t counts[2] = {mesh.vertices.cols(), mesh.faces.cols()};
  Sha256 hash;
  hash.update(counts, sizeof counts);
  const Points rounded = mesh.vertices.cast<float>().cast<double>();
  hash.update(rounded.data(), static_cast<std::size_t>(rounded.size()) * sizeof(double));
  hash.update(mesh.faces.data(), static_cast<std::size_t>(mesh.faces.size()) * sizeof(int));
  return hash.finish();
}

}  // namespace bespoke
