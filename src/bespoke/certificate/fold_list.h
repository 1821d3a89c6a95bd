#pragma once

#include <memory>
#include <vector>

#include "bespoke/certificate/certificate.h"

namespace bespoke {

/// The folded and undecided cells of a pyramid whose values change while its leaves stay: what lies around
/// the changed nodes is certified again, the rest is not looked at.
class FoldList {
 public:
  /// `pyramid` must outlive the list; `places` are those of its certificate at t = 1, all of them.
  FoldList(const Pyramid& pyramid, const AffineMap& affine, std::vector<FoldedCell> places);
  ~FoldList();

  /// `changed[level]`: nodes of that level.
  void update(const std::vector<std::vector<LatticeCoordinates>>& changed);

  const std::vector<FoldedCell>& places() const { return places_; }

 private:
  struct Cells;
  std::unique_ptr<Cells> cells_;
  std::vector<FoldedCell> places_;
};

}  // namespace bespoke
