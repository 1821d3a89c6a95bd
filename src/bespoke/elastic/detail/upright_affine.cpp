#include "bespoke/elastic/detail/upright_affine.h"

#include <Eigen/LU>
#include <string>

#include "bespoke/error.h"
#include "bespoke/rigid/affine_alignment.h"
#include "bespoke/rigid/similarity_alignment.h"

namespace bespoke {

AffineMap upright_affine(const Points& sources, const Points& targets, AffinePart part) {
  if (part == AffinePart::similarity) {
    const Similarity similarity = align_similarly(sources, targets, Eigen::VectorXd::Ones(sources.cols()));
    return {similarity.scale * similarity.rotation, similarity.translation};
  }
  AffineMap map = align_affinely(sources, targets, FlatDirections::of_squared_width_1e_12);
  if (!(map.linear.determinant() > 0))
    throw InvalidInput("the affine part of the correspondences has determinant " +
                       std::to_string(map.linear.determinant()) +
                       ", so one model is a mirror image of the other or is flattened; mirror it back first");
  return map;
}

}  // namespace bespoke
