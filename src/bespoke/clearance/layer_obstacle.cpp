#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "bespoke/clearance/obstacle.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/equal_positions.h"
#include "bespoke/mesh/facing_outward.h"
#include "bespoke/mesh/mesh_edges.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

constexpr double nothing_required = -std::numeric_limits<double>::infinity();

// Layers farther apart than this share of the diagonal are not in each other's way: two bands of the grids.
constexpr double layer_reach = 0.025;

// Of the distance to the nearest place, along the normal there: less, and the place lies beside the layer,
// beyond its rim or across a crease.
constexpr double min_height = 0.3;

constexpr std::size_t planes_per_range = 256;

/// Vertices at one position are one, faces look outward.
TriangleMesh joined_outward(TriangleMesh mesh) {
  const std::vector<int> first = first_at_equal_position(mesh.vertices);
  for (int& vertex : mesh.faces.reshaped()) vertex = first[static_cast<std::size_t>(vertex)];
  if (faces_outward(mesh) == false) mesh.faces.row(1).swap(mesh.faces.row(2));
  return mesh;
}

class Layer {
 public:
  Layer(const TriangleMesh& before, const Points& after, const ModelSizes& sizes)
      : before_(joined_outward(before)),
        after_{after, before_.faces},
        normals_before_(vertex_normals(before_)),
        normals_after_(vertex_normals(after_)),
        is_boundary_(boundary_vertices(before_)),
        tree_(before_),
        scale_(sizes.scale()),
        reach_(layer_reach * sizes.source_diagonal) {}

  double reach() const { return reach_; }

  SidePlanes planes(const Points& x) const {
    const auto count = static_cast<std::size_t>(x.cols());
    SidePlanes planes{Points::Zero(3, x.cols()), Points::Zero(3, x.cols()),
                      std::vector<double>(count, nothing_required)};
    parallel_for(count, planes_per_range, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) set_plane(x, i, planes);
    });
    return planes;
  }

 private:
  void set_plane(const Points& x, std::size_t i, SidePlanes& planes) const {
    const auto column = static_cast<Eigen::Index>(i);
    const auto near = tree_.closest(x.col(column), {.max_distance = reach_});
    if (!near || is_on_rim(*near)) return;
    const Vector3 offset = x.col(column) - near->point;
    if (!(offset.dot(normal(*near, normals_before_)) > min_height * offset.norm())) return;
    const Vector3 above = normal(*near, normals_after_);
    if (above.isZero(0)) return;
    planes.origins.col(column) = carried(*near, after_.faces, after_.vertices);
    planes.normals.col(column) = above;
    planes.required[i] = scale_ * offset.norm();
  }

  Vector3 normal(const SurfacePoint& at, const Points& of_vertices) const {
    Vector3 sum = Vector3::Zero();
    for (int k = 0; k < 3; ++k) sum += at.barycentric[k] * of_vertices.col(before_.faces(k, at.face));
    return sum.norm() > 0 ? Vector3(sum.normalized()) : Vector3(Vector3::Zero());
  }

  /// Whether all corners that it lies between are on the boundary, so that it may lie on an edge of it.
  bool is_on_rim(const SurfacePoint& at) const {
    for (int k = 0; k < 3; ++k)
      if (at.barycentric[k] > 0 && !is_boundary_[static_cast<std::size_t>(before_.faces(k, at.face))])
        return false;
    return true;
  }

  TriangleMesh before_, after_;
  Points normals_before_, normals_after_;
  std::vector<char> is_boundary_;
  ClosestPointTree tree_;
  double scale_, reach_;
};

}  // namespace

Obstacle layer_obstacle(std::string name, const TriangleMesh& before, const Points& after,
                        const ModelSizes& sizes) {
  const auto layer = std::make_shared<const Layer>(before, after, sizes);
  Obstacle obstacle;
  obstacle.name = std::move(name);
  obstacle.tolerance = clearance_tolerance * sizes.target_diagonal;
  obstacle.planes = [layer](const Points& x) { return layer->planes(x); };
  obstacle.layer = std::make_shared<const LayerFaces>(LayerFaces{before, after});
  obstacle.layer_reach = layer->reach();
  return obstacle;
}

}  // namespace bespoke
