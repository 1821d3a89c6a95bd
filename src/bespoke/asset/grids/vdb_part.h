#pragma once

#include <cstddef>
#include <memory>
#include <streambuf>
#include <vector>

#include "bespoke/asset/grids/stored_grid.h"
#include "bespoke/lattice/pyramid_part.h"

namespace bespoke {

/// A grid of which all leaves are known, but the values of some.
struct StoredGridPart {
  StoredGrid grid;                          ///< with the leaves that were read, maybe none
  std::vector<LeafCoordinates> all_leaves;  ///< of the file's grid, in lexicographic order
};

/// A .vdb file that is read grid by grid, and of a grid the leaves in a box: OpenVDB reads the whole grid's
/// tree, and seeks past the values of other leaves. Throws FormatError as stored_file_from_vdb, and what
/// the bytes throw.
class VdbPart {
 public:
  /// Reads metadata and the places of the grids. `bytes` can be sought in and must outlive this.
  explicit VdbPart(std::streambuf& bytes);
  ~VdbPart();

  const Metadata& metadata() const;
  std::size_t grid_count() const;

  /// A Vec3S grid.
  StoredGridPart read(std::size_t grid, const LeafBox& leaves);

 private:
  struct Archive;
  std::unique_ptr<Archive> archive_;
};

}  // namespace bespoke
