#pragma once

#include <functional>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// Visits a matrix per region: the area-weighted mean of `value(face)` over the faces whose centroids lie in
/// a ball. The balls, of 5 % of the mesh's bounding-box diagonal, cover all faces with area.
void for_each_region(const TriangleMesh& mesh, const Eigen::VectorXd& areas,
                     const std::function<Matrix3(Eigen::Index face)>& value,
                     const std::function<void(const Matrix3& mean)>& visit);

}  // namespace bespoke
