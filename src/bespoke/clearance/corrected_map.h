#pragma once

#include <memory>

#include "bespoke/clearance/prepared_product.h"
#include "bespoke/mapping/elastic_map.h"
#include "bespoke/rigid/rigid_transform.h"

namespace bespoke {

/// A map that takes a product to where it was corrected: E and, at a place of the product, what the place was
/// moved by; elsewhere what the nearest place of its faces (of its vertices, without faces) was. ∇ of that is
/// of least squares over the edges around a place, and zero across the surface, so that normals turn with the
/// faces. A product's own way of writing (parts, splits, normals) so holds for corrected ones too.
/// `corrected` and `carried`: 3×n, its vertices in the target frame with and without
/// the correction. Throws InvalidInput where the sizes differ.
std::shared_ptr<const ElasticMap> corrected_map(std::shared_ptr<const ElasticMap> elastic,
                                                const RigidTransform& target_from_source,
                                                std::shared_ptr<const PreparedProduct> product,
                                                const Points& carried, const Points& corrected);

}  // namespace bespoke
