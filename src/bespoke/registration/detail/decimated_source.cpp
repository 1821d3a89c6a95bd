#include "bespoke/registration/detail/decimated_source.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "bespoke/mesh/closest_point.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

constexpr std::size_t grain = 512;
/// Of an edge: a normal decides where the edges lie in one plane only.
constexpr double normal_length = 0.03;

/// Normal equations of the affine map that moves edges and the normal at a vertex.
struct LocalMap {
  Matrix3 rest = Matrix3::Zero();   // Σ e eᵀ
  Matrix3 moved = Matrix3::Zero();  // Σ e' eᵀ

  void add(const Vector3& at_rest, const Vector3& as_moved) {
    rest += at_rest * at_rest.transpose();
    moved += as_moved * at_rest.transpose();
  }
  Matrix3 solved() const {
    // Towards the identity, where faces without area determine nothing.
    const Matrix3 ridge = Matrix3::Identity() * std::max(1e-9 * rest.trace(), 1e-300);
    return (rest + ridge).ldlt().solve((moved + ridge).transpose()).transpose();
  }
};

/// Of every vertex, where `mesh` has its vertices at `moved`.
std::vector<Matrix3> local_maps(const TriangleMesh& mesh, const Points& moved) {
  std::vector<LocalMap> maps(static_cast<std::size_t>(mesh.vertices.cols()));
  for (const auto& face : mesh.faces.colwise()) {
    const auto edge = [&](const Points& at, int k) -> Vector3 {
      return at.col(face[(k + 1) % 3]) - at.col(face[k]);
    };
    // It grows as the face does.
    const auto normal = [&](const Points& at) -> Vector3 {
      const Vector3 doubled_area = edge(at, 0).cross(edge(at, 1));
      return normal_length / std::sqrt(std::max(doubled_area.norm(), 1e-300)) * doubled_area;
    };
    const Vector3 normal_at_rest = normal(mesh.vertices), moved_normal = normal(moved);
    for (int k = 0; k < 3; ++k) {
      LocalMap& map = maps[static_cast<std::size_t>(face[k])];
      map.add(edge(mesh.vertices, k), edge(moved, k));
      map.add(edge(mesh.vertices, (k + 2) % 3), edge(moved, (k + 2) % 3));
      map.add(normal_at_rest, moved_normal);
    }
  }
  std::vector<Matrix3> solved(maps.size());
  parallel_for(maps.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) solved[k] = maps[k].solved();
  });
  return solved;
}

}  // namespace

DecimatedSource::DecimatedSource(const TriangleMesh& whole, std::size_t max_faces)
    : whole_(whole),
      decimated_(decimated(whole, max_faces)),
      feet_(static_cast<std::size_t>(whole.vertices.cols())) {
  const ClosestPointTree tree(decimated_.mesh);
  const Points normals = vertex_normals(whole);
  // Of two sheets that nearly touch, the one that faces alike.
  const double edge = std::sqrt(vertex_areas(decimated_.mesh).mean());
  parallel_for(feet_.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Vector3 x = whole.vertices.col(static_cast<Eigen::Index>(k));
      const Vector3 normal = normals.col(static_cast<Eigen::Index>(k));
      std::optional<SurfacePoint> foot;
      if (normal.squaredNorm() > 0) foot = tree.closest(x, {.normal = normal, .normal_length = edge});
      if (!foot) foot = tree.closest(x);
      feet_[k] = {foot->face, foot->barycentric};
    }
  });
}

Points DecimatedSource::followed(const Points& moved) const {
  const TriangleMesh& mesh = decimated_.mesh;
  const std::vector<Matrix3> maps = local_maps(mesh, moved);
  Points result(3, whole_.vertices.cols());
  parallel_for(feet_.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      const auto corners = mesh.faces.col(feet_[k].face);
      const Vector3 foot = mesh.vertices(Eigen::all, corners) * feet_[k].barycentric;
      const Vector3 above = whole_.vertices.col(i) - foot;
      Vector3 place = Vector3::Zero();
      for (int c = 0; c < 3; ++c) {
        const Matrix3& map = maps[static_cast<std::size_t>(corners[c])];
        const Vector3 within = foot - mesh.vertices.col(corners[c]);
        place += feet_[k].barycentric[c] * (moved.col(corners[c]) + map * (0.5 * within + above));
      }
      result.col(i) = place;
    }
  });
  return result;
}

std::vector<int> DecimatedSource::followers(const std::vector<int>& leading) const {
  std::vector<char> leads(decimated_.vertices.size(), 0);
  for (const int vertex : leading) leads[static_cast<std::size_t>(vertex)] = 1;
  std::vector<int> result;
  for (std::size_t k = 0; k < feet_.size(); ++k) {
    const auto corners = decimated_.mesh.faces.col(feet_[k].face);
    if (std::any_of(corners.begin(), corners.end(),
                    [&](int corner) { return leads[static_cast<std::size_t>(corner)] != 0; }))
      result.push_back(static_cast<int>(k));
  }
  return result;
}

std::vector<double> DecimatedSource::interpolated(const std::vector<double>& values) const {
  std::vector<double> result(feet_.size(), 0.0);
  for (std::size_t k = 0; k < feet_.size(); ++k)
    for (int c = 0; c < 3; ++c)
      result[k] +=
          feet_[k].barycentric[c] * values[static_cast<std::size_t>(decimated_.mesh.faces(c, feet_[k].face))];
  return result;
}

}  // namespace bespoke
