#include "bespoke/quality/distortion.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

#include "bespoke/bake/band.h"
#include "bespoke/error.h"
#include "bespoke/mesh/mesh_edges.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

double fraction(double x) { return x - std::floor(x); }

// Point i of the R3 sequence (Roberts 2018), which covers the unit cube evenly.
Vector3 spread_over_cube(std::size_t i) {
  constexpr double root = 1.22074408460575947536;  // of x⁴ = x + 1
  const auto n = static_cast<double>(i);
  return {fraction(0.5 + n / root), fraction(0.5 + n / (root * root)),
          fraction(0.5 + n / (root * root * root))};
}

// The leaves of a lattice, fine enough to follow the support's shape, that meet it: each gets as many points.
Points band_samples(const Support& support, std::size_t samples) {
  const Box box = bounding_box(support);
  if (box.isEmpty()) return Points(3, 0);
  if (!box.diagonal().allFinite()) throw InvalidInput("the support of the map is not finite");
  constexpr std::size_t enough_leaves = 20000;
  Lattice lattice{box.min(), box.diagonal().maxCoeff() / (8 * leaf_edge)};
  while (count_band_leaves(support, lattice) < enough_leaves &&
         lattice.voxel_size * 512 > box.diagonal().maxCoeff() / leaf_edge)
    lattice.voxel_size /= 2;
  const std::vector<LeafCoordinates> leaves = band_leaves(support, lattice);
  const std::size_t per_leaf = std::max<std::size_t>(1, samples / std::max<std::size_t>(1, leaves.size()));
  Points points(3, static_cast<Eigen::Index>(leaves.size() * per_leaf));
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const LeafCoordinates& leaf = leaves[static_cast<std::size_t>(i) / per_leaf];
    points.col(i) = lattice.at(leaf_edge * (as_vector(leaf) + spread_over_cube(static_cast<std::size_t>(i))));
  }
  return points;
}

Points columns_in_band(const Points& x, const Points& u) {
  Points kept(3, x.cols());
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    if (!u.col(i).isZero(0)) kept.col(count++) = x.col(i);
  return kept.leftCols(count);
}

struct PointDistortions {
  std::vector<double> conformal, area, volume;
};

/// Of one Jacobian into place i.
void set(PointDistortions& to, std::size_t i, const Matrix3& jacobian) {
  const Vector3 singular = Eigen::JacobiSVD<Matrix3>(jacobian).singularValues();
  to.conformal[i] = singular(0) / singular(2);
  to.area[i] = singular(0) * singular(1);
  to.volume[i] = jacobian.determinant();
}

PointDistortions of_size(std::size_t count) {
  return {std::vector<double>(count), std::vector<double>(count), std::vector<double>(count)};
}

PointDistortions distortions(const ElasticMap& map, const Points& x) {
  const Points gradient = map.displacement_gradient(x);
  const Matrix3 linear = map.affine().linear;
  const auto count = static_cast<std::size_t>(x.cols());
  PointDistortions result = of_size(count);
  parallel_for(count, 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      set(result, i, linear + gradient.middleCols<3>(3 * static_cast<Eigen::Index>(i)));
  });
  return result;
}

// Angle at a of the triangle a b c, radians.
double angle(const Vector3& a, const Vector3& b, const Vector3& c) {
  return std::atan2((b - a).cross(c - a).norm(), (b - a).dot(c - a));
}

}  // namespace

Spread spread(std::vector<double> values) {
  if (values.empty()) return {};
  const std::vector<double> sorted = sorted_finite(std::move(values));
  return {sorted.size(),
          sorted.front(),
          nearest_rank(sorted, 0.01),
          nearest_rank(sorted, 0.5),
          nearest_rank(sorted, 0.99),
          sorted.back()};
}

std::string to_string(const Spread& spread) {
  char text[160];
  std::snprintf(text, sizeof text, "min %.4g p1 %.4g median %.4g p99 %.4g max %.4g", spread.min, spread.p1,
                spread.median, spread.p99, spread.max);
  return text;
}

MapDistortion map_distortion(const ElasticMap& map, const MapDistortionOptions& options,
                             const Progress& progress) {
  if (options.samples == 0) throw InvalidInput("map distortion needs at least one sample");
  const Points x = band_samples(map.support(), options.samples);
  constexpr Eigen::Index batch = 1 << 16;  // points: bounds the memory that gradients take
  MapDistortion result;
  PointDistortions all;
  for (Eigen::Index begin = 0; begin < x.cols(); begin += batch) {
    progress.step("distortion", static_cast<std::size_t>(begin), static_cast<std::size_t>(x.cols()));
    const Points part = x.middleCols(begin, std::min(batch, x.cols() - begin));
    const PointDistortions found = distortions(map, columns_in_band(part, map.displacement(part)));
    for (const double value : found.conformal)
      if (std::isfinite(value)) all.conformal.push_back(value);
    all.area.insert(all.area.end(), found.area.begin(), found.area.end());
    all.volume.insert(all.volume.end(), found.volume.begin(), found.volume.end());
  }
  for (const double volume : all.volume) result.flips += !(volume > 0);
  result.samples = all.volume.size();
  if (result.samples == 0) {  // affine everywhere
    PointDistortions affine = of_size(1);
    set(affine, 0, map.affine().linear);
    all.area = affine.area;
    all.volume = affine.volume;
    if (std::isfinite(affine.conformal[0])) all.conformal = affine.conformal;
  }
  result.conformal = spread(std::move(all.conformal));
  result.area = spread(std::move(all.area));
  result.volume = spread(std::move(all.volume));
  result.min_determinant = result.volume.min;
  return result;
}

std::size_t flipped_faces(const TriangleMesh& mesh, const Points& mapped, const ElasticMap& map) {
  if (mapped.cols() != mesh.vertices.cols())
    throw InvalidInput("flipped_faces got " + std::to_string(mapped.cols()) + " mapped vertices of " +
                       std::to_string(mesh.vertices.cols()));
  Points centers(3, mesh.faces.cols());
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face)
    centers.col(face) = (mesh.vertices.col(mesh.faces(0, face)) + mesh.vertices.col(mesh.faces(1, face)) +
                         mesh.vertices.col(mesh.faces(2, face))) /
                        3;
  const Points gradient = map.displacement_gradient(centers);
  const Points normals = face_normals(mesh);
  const Points mapped_normals = face_normals({mapped, mesh.faces});
  std::size_t flipped = 0;
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    if (normals.col(face).isZero(0)) continue;
    const Matrix3 jacobian = map.affine().linear + gradient.middleCols<3>(3 * face);
    flipped += !((jacobian * normals.col(face)).dot(mapped_normals.col(face)) > 0);
  }
  return flipped;
}

MeshDistortion mesh_distortion(const TriangleMesh& before, const Points& after) {
  if (after.cols() != before.vertices.cols())
    throw InvalidInput("mesh_distortion got " + std::to_string(after.cols()) + " vertices after and " +
                       std::to_string(before.vertices.cols()) + " before");
  MeshDistortion result;
  std::vector<double> ratios, angles;
  const VertexAdjacency adjacency = vertex_adjacency(before);
  for (Eigen::Index vertex = 0; vertex < after.cols(); ++vertex) {
    const auto at = static_cast<std::size_t>(vertex);
    for (int k = adjacency.start[at]; k < adjacency.start[at + 1]; ++k) {
      const int other = adjacency.neighbours[static_cast<std::size_t>(k)];
      if (other < vertex) continue;
      const double length = (before.vertices.col(vertex) - before.vertices.col(other)).norm();
      if (length > 0)
        ratios.push_back((after.col(vertex) - after.col(other)).norm() / length);
      else
        ++result.left_out_edges;
    }
  }
  const Points normals = face_normals(before), normals_after = face_normals({after, before.faces});
  for (Eigen::Index face = 0; face < before.faces.cols(); ++face) {
    if (normals.col(face).isZero(0) || normals_after.col(face).isZero(0)) {
      ++result.left_out_faces;
      continue;
    }
    for (int k = 0; k < 3; ++k) {
      const int a = before.faces(k, face), b = before.faces((k + 1) % 3, face),
                c = before.faces((k + 2) % 3, face);
      angles.push_back(
          std::abs(angle(after.col(a), after.col(b), after.col(c)) -
                   angle(before.vertices.col(a), before.vertices.col(b), before.vertices.col(c))) *
          180 / std::numbers::pi);
    }
  }
  result.edge_length = spread(std::move(ratios));
  result.angle = summarize(std::move(angles));
  return result;
}

}  // namespace bespoke
