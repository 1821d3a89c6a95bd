#include "bespoke/elastic/pffd.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "bespoke/elastic/detail/face_frames.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/parallel.h"
#include "bespoke/rbf/point_grid.h"

namespace bespoke {
namespace {

// Of Eq. 18.
constexpr double neighbourhood_ratio = 1.5;
constexpr double weight_offset = 1e-8;  // mesh units³

Points centres(const std::vector<Matrix3>& triangles) {
  Points result(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t i = 0; i < triangles.size(); ++i)
    result.col(static_cast<Eigen::Index>(i)) = triangles[i].rowwise().mean();
  return result;
}

TriangleMesh with_faces(const TriangleMesh& mesh, const std::vector<int>& faces) {
  return {mesh.vertices, mesh.faces(Eigen::all, faces)};
}

/// Mean distance of the triangles' corners from their centres, mesh units.
double mean_radius(const std::vector<Matrix3>& triangles) {
  double sum = 0;
  for (const Matrix3& triangle : triangles)
    sum += (triangle.colwise() - Vector3(triangle.rowwise().mean())).colwise().norm().mean();
  return sum / static_cast<double>(triangles.size());
}

struct Neighbour {
  int face;
  double distance;  // of its centre from x, mesh units
};

/// Σ w f / Σ w over the neighbours, for the faces' maps minus the background map, about the frames' origin.
struct Mean {
  Vector3 shift = Vector3::Zero();
  Matrix3 linear = Matrix3::Zero();
  double weight = 0;
};

double weight_at(double distance) { return 1 / (weight_offset + distance * distance * distance); }

}  // namespace

struct PffdMap::Faces {
  FaceFrames source;
  Points centers;  // 3×m
  PointGrid grid;  // of the centres
  ClosestPointTree surface;
  double lambda;

  Faces(const TriangleMesh& mesh, const Points& fitted, double reach)
      : source(face_frames(mesh, fitted, reach)),
        centers(centres(source.triangles)),
        // Visits are as wide as the distance from the surface, λ at most, and the face there.
        grid(centers, std::max(reach / 4, mean_radius(source.triangles))),
        surface(with_faces(mesh, source.mesh_faces)),
        lambda(reach) {}

  /// Empty farther than λ from the surface.
  void find(const Vector3& x, std::vector<Neighbour>& near) const {
    near.clear();
    const std::optional<SurfacePoint> closest = surface.closest(x, {.max_distance = lambda});
    if (!closest) return;
    // The nearest centre is no farther than that of the nearest face.
    const double within = (centers.col(closest->face) - x).norm();
    // Squares round: a little wider, so that this face itself is never lost.
    constexpr double margin = 1 + 1e-12;
    double nearest = std::numeric_limits<double>::infinity();
    grid.for_each_within(x, margin * neighbourhood_ratio * within, [&](int face, double squared) {
      near.push_back({face, std::sqrt(squared)});
      nearest = std::min(nearest, near.back().distance);
    });
    std::erase_if(near, [&](const Neighbour& at) {
      return !(at.distance < neighbourhood_ratio * nearest || at.distance == nearest);
    });
  }

  Mean mean(const std::vector<Neighbour>& near) const {
    Mean result;
    for (const Neighbour& at : near) {
      const FaceFrame& face = source.frames[static_cast<std::size_t>(at.face)];
      const double weight = weight_at(at.distance);
      result.shift += weight * face.shift;
      result.linear += weight * face.linear;
      result.weight += weight;
    }
    result.shift /= result.weight;
    result.linear /= result.weight;
    return result;
  }

  /// The mean of the linear parts and the change of the weights: ∇w = −3 w² d (x − centre).
  Matrix3 gradient(const std::vector<Neighbour>& near, const Vector3& x) const {
    const Mean all = mean(near);
    const Vector3 displacement = all.shift + all.linear * (x - source.origin);
    Matrix3 change = Matrix3::Zero();
    for (const Neighbour& at : near) {
      const FaceFrame& face = source.frames[static_cast<std::size_t>(at.face)];
      const double weight = weight_at(at.distance);
      const Vector3 off = face.shift + face.linear * (x - source.origin) - displacement;
      const Vector3 arm = x - centers.col(at.face);
      change -= (3 * weight * weight * at.distance) * off * arm.transpose();
    }
    return all.linear + change / all.weight;
  }

  template <class Take>
  void for_each_neighbourhood(const Points& x, const Take& take) const {
    parallel_for(static_cast<std::size_t>(x.cols()), 32, [&](std::size_t begin, std::size_t end) {
      std::vector<Neighbour> near;
      for (auto i = static_cast<Eigen::Index>(begin); i < static_cast<Eigen::Index>(end); ++i) {
        find(x.col(i), near);
        if (!near.empty()) take(i, near);
      }
    });
  }
};

PffdMap::PffdMap(const TriangleMesh& source, const Points& fitted, double lambda)
    : source_(source),
      fitted_(fitted),
      lambda_(lambda),
      faces_(std::make_unique<const Faces>(source, fitted, lambda)) {}

PffdMap::~PffdMap() = default;

AffineMap PffdMap::affine() const { return faces_->source.affine; }

Points PffdMap::displacement(const Points& x) const {
  Points result = Points::Zero(3, x.cols());
  faces_->for_each_neighbourhood(x, [&](Eigen::Index i, const std::vector<Neighbour>& near) {
    const Mean mean = faces_->mean(near);
    result.col(i) = mean.shift + mean.linear * (x.col(i) - faces_->source.origin);
  });
  return result;
}

Points PffdMap::displacement_gradient(const Points& x) const {
  Points result = Points::Zero(3, 3 * x.cols());
  faces_->for_each_neighbourhood(x, [&](Eigen::Index i, const std::vector<Neighbour>& near) {
    result.middleCols<3>(3 * i) = faces_->gradient(near, x.col(i));
  });
  return result;
}

Support PffdMap::support() const { return support_around(source_, faces_->source.mesh_faces, lambda_); }

std::string to_string(const PffdSummary& summary) { return std::to_string(summary.faces) + " faces"; }

std::vector<Figure> figures(const PffdSummary&) { return {}; }

void write_exact(const PffdMap& map, ExactMapWriter& writer) {
  write_face_map(map.source(), map.fitted(), map.lambda(), writer);
}

std::shared_ptr<const PffdMap> read_pffd(ExactMapReader& reader) {
  const FaceMap map = read_face_map(reader);
  return std::make_shared<PffdMap>(map.source, map.fitted, map.lambda);
}

}  // namespace bespoke
