#include "bespoke/page/detail/vertex_fields.h"

#include <Eigen/SVD>
#include <cmath>
#include <utility>

#include "bespoke/parallel.h"

namespace bespoke {
namespace {

constexpr std::size_t points_per_chunk = 2048;
constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

/// Two unit vectors perpendicular to a unit normal.
Eigen::Matrix<double, 3, 2> tangents(const Vector3& normal) {
  Eigen::Matrix<double, 3, 2> plane;
  plane.col(0) = normal.unitOrthogonal();
  plane.col(1) = normal.cross(plane.col(0));
  return plane;
}

struct Stretch {
  double largest = 0, smallest = 0;
};

Stretch stretch(const Matrix3& gradient, const Vector3& normal) {
  if (normal.isZero(0)) {
    const Vector3 values = Eigen::JacobiSVD<Matrix3>(gradient).singularValues();
    return {values[0], values[2]};
  }
  const Eigen::Matrix<double, 3, 2> along = gradient * tangents(normal);
  const Eigen::Vector2d values = Eigen::JacobiSVD<Eigen::Matrix<double, 3, 2>>(along).singularValues();
  return {values[0], values[1]};
}

}  // namespace

std::vector<VertexField> deformation_fields(const ElasticMap& elastic, const Points& vertices,
                                            const Points& normals) {
  const auto count = static_cast<std::size_t>(vertices.cols());
  const auto field = [&](const char* id, const char* label, bool is_length, std::optional<double> middle) {
    return VertexField{id, label, is_length, middle, std::vector<double>(count)};
  };
  std::vector<VertexField> fields{field("displacement", "elastic displacement", true, std::nullopt),
                                  field("largest_stretch", "largest stretch", false, 1),
                                  field("smallest_stretch", "smallest stretch", false, 1),
                                  field("area", "area after / before", false, 1),
                                  field("determinant", "det of the gradient", false, 1)};
  const Points moved = elastic(vertices);
  const Points gradients = elastic.displacement_gradient(vertices);
  const Matrix3 linear = elastic.affine().linear;
  parallel_for(count, points_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const auto column = static_cast<Eigen::Index>(v);
      const Matrix3 gradient = linear + gradients.middleCols<3>(3 * column);
      const Stretch found = stretch(gradient, normals.col(column));
      fields[0].values[v] = (moved.col(column) - vertices.col(column)).norm();
      fields[1].values[v] = found.largest;
      fields[2].values[v] = found.smallest;
      fields[3].values[v] = found.largest * found.smallest;
      fields[4].values[v] = gradient.determinant();
    }
  });
  // Without a surface there is no area.
  for (std::size_t v = 0; v < count; ++v)
    if (normals.col(static_cast<Eigen::Index>(v)).isZero(0)) fields[3].values[v] = not_known;
  return fields;
}

std::vector<VertexField> clearance_fields(const SignedDistance& from_source,
                                          const SignedDistance& from_target, const Points& before,
                                          const Points& after) {
  const SignedDistance::Values at_source = from_source(before), at_target = from_target(after);
  VertexField first{"clearance_before", "clearance to the source, before", true, 0, {}};
  VertexField second{"clearance_after", "clearance to the target, after", true, 0, {}};
  VertexField change{"clearance_change", "change of clearance", true, 0, {}};
  for (std::size_t v = 0; v < at_source.distance.size(); ++v) {
    first.values.push_back(at_source.sided[v] ? at_source.distance[v] : not_known);
    second.values.push_back(at_target.sided[v] ? at_target.distance[v] : not_known);
    change.values.push_back(second.values.back() - first.values.back());
  }
  return {std::move(change), std::move(second), std::move(first)};
}

VertexField carried_clearance_field(const SignedDistance& from_target, const Points& carried) {
  const SignedDistance::Values at_target = from_target(carried);
  VertexField field{"clearance_carried", "clearance to the target, not corrected", true, 0, {}};
  for (std::size_t v = 0; v < at_target.distance.size(); ++v)
    field.values.push_back(at_target.sided[v] ? at_target.distance[v] : not_known);
  return field;
}

VertexField move_field(const Points& carried, const Points& corrected) {
  const Eigen::VectorXd moves = (corrected - carried).colwise().norm();
  return {"moved", "moved by the correction", true, std::nullopt, {moves.begin(), moves.end()}};
}

VertexField distance_field(std::string id, std::string label, const SignedDistance& surface,
                           const Points& points) {
  VertexField field{std::move(id), std::move(label), true, std::nullopt, surface(points).distance};
  for (double& value : field.values) value = std::abs(value);
  return field;
}

}  // namespace bespoke
