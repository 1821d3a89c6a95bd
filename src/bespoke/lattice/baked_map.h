#pragma once

#include <memory>
#include <utility>

#include "bespoke/lattice/pyramid.h"
#include "bespoke/mapping/elastic_map.h"

namespace bespoke {

/// Where the sum of the levels may be nonzero.
Support support_of(const Pyramid& pyramid);

/// An elastic map whose u is the sum of a pyramid's levels, each looked up trilinearly. Exactly affine where
/// no level has a leaf within one cell. Gradients are those of the cell that holds the point (on a face
/// shared by two cells, of the upper one).
class BakedMap : public ElasticMap {
 public:
  /// Throws InvalidInput for a pyramid that is not valid.
  BakedMap(AffineMap affine, Pyramid pyramid);
  ~BakedMap() override;

  AffineMap affine() const override { return affine_; }
  Points displacement(const Points& x) const override;
  Points displacement_gradient(const Points& x) const override;
  Support support() const override;

  const Pyramid& pyramid() const { return pyramid_; }

  /// The pyramid back, without a copy; the map is at an end.
  Pyramid release() && { return std::move(pyramid_); }

 private:
  struct Index;
  AffineMap affine_;
  Pyramid pyramid_;
  std::unique_ptr<const Index> index_;
};

}  // namespace bespoke
