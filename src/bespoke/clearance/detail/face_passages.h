#pragma once

#include <cstddef>
#include <optional>
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
  /// `carried`: 3×n, the product's vertices on the target, where they are at first.
  FacePassages(const TriangleMesh& product, const Points& carried, const std::vector<Obstacle>& obstacles);

  /// The product's vertices are here (3×n).
  void move_to(const Points& vertices) { now_.vertices.leftCols(product_vertices_) = vertices; }
  /// In increasing order. Looks at what is not as carried and, where there are layers, at all faces.
  FacePairs found();
  /// Of them those of the product alone.
  FacePairs of_product(const FacePairs& pairs) const;
  /// Of each layer, in the order of the obstacles: those on the source, and of `pairs`. After `found`.
  std::vector<LayerPairs> of_layers(const FacePairs& pairs) const;

  /// Where they are, one in a neighbourhood of `radius` (mesh units), ten at most.
  std::vector<PassedThrough> places(const FacePairs& pairs, double radius) const;

  /// Those of the product's faces in the pair.
  void add_vertices(const std::pair<int, int>& pair, std::vector<int>& vertices) const;

  /// What has the faces of the pairs apart again, by `margin` (mesh units), moving the product alone.
  std::vector<Push> pushes(const FacePairs& pairs, double margin) const;

 private:
  Matrix3 corners(int face, const Points& vertices) const;
  bool has_layers() const { return ends_.size() > 1; }
  void add_pushes(const std::pair<int, int>& pair, double margin, std::vector<Push>& pushes) const;
  bool is_of_product(int face) const { return face < product_faces_; }
  const std::string& name_of(int face) const;

  int product_faces_;
  Eigen::Index product_vertices_;
  TriangleMesh now_;                               // the product, then the layers
  Points on_source_, carried_;                     // the same vertices
  std::optional<FacePairs> through_layers_;        // on the source, once they are needed: left as they are
  std::vector<std::pair<int, std::string>> ends_;  // after which face the product and each layer end
};

}  // namespace bespoke
