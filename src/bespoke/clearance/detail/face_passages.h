#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/clearance/detail/correction.h"
#include "bespoke/clearance/keep_clear.h"

namespace bespoke {

/// Pairs of faces, numbered through the product and the layers below it.
using FacePairs = std::vector<std::pair<int, int>>;

/// Which faces of a product pass through each other or through a layer below, though they did not before:
/// among themselves as carried, through layers on the source.
class FacePassages {
 public:
  /// `carried`: 3×n, the product's vertices on the target. All must outlive it.
  FacePassages(const TriangleMesh& product, const Points& carried, const std::vector<Obstacle>& obstacles);

  /// With the product's vertices here (3×n), in increasing order.
  FacePairs found(const Points& vertices);
  /// Of them those of the product alone.
  FacePairs of_product(const FacePairs& pairs) const;

  /// Where they are, one in a neighbourhood of `radius` (mesh units), ten at most.
  std::vector<PassedThrough> places(const FacePairs& pairs, double radius) const;

  /// Those of the product's faces in the pair.
  void add_vertices(const std::pair<int, int>& pair, std::vector<int>& vertices) const;

  /// What has the faces of the pairs apart again, by `margin` (mesh units), moving the product alone.
  std::vector<Push> pushes(const FacePairs& pairs, double margin) const;

 private:
  Matrix3 corners(int face, const Points& vertices) const;
  void add_pushes(const std::pair<int, int>& pair, double margin, std::vector<Push>& pushes) const;
  bool is_of_product(int face) const { return face < product_faces_; }
  const std::string& name_of(int face) const;

  int product_faces_;
  Eigen::Index product_vertices_;
  TriangleMesh now_;            // the product, then the layers
  Points on_source_, carried_;  // the same vertices
  FacePairs before_;
  std::vector<std::pair<int, std::string>> ends_;  // after which face the product and each layer end
};

}  // namespace bespoke
