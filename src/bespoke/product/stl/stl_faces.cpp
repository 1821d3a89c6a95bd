#include <vector>

#include "bespoke/error.h"
#include "bespoke/product/faces/face_formats.h"
#include "bespoke/product/faces/gathered_faces.h"
#include "bespoke/product/stl/stl_file.h"

namespace bespoke {
namespace {

Points binary_stl_corners(const InputFile& file, std::size_t facets) {
  GatheredFaces gathered(file.path());
  FacetCutter cutter;
  walk_blocks(
      {file, stl_header_size}, [&](const Window& window) { return cutter(window); },
      [&](const FacetBlock& block) { return facet_points(block, file, facets); },
      [&](const FacetBlock&, Points&& stored) {
        Points corners(3, stored.cols() / 4 * 3);
        for (Eigen::Index i = 0; i < stored.cols() / 4; ++i)
          corners.middleCols<3>(3 * i) = stored.middleCols<3>(4 * i + 1);
        gathered.add_points(corners);
      },
      {});
  return gathered.product(false).vertices;
}

}  // namespace

Product read_stl_faces(const InputFile& file) {
  const std::optional<std::size_t> facets = binary_stl_facets(file);
  if (facets) require_countable(3 * *facets, file.path());
  const Points corners = facets ? binary_stl_corners(file, *facets)
                                : gather_text(file, StlText(file.path(), false)).product(false).vertices;
  if (corners.cols() == 0) throw FormatError(file.path().string() + ": the file has no facets");
  return joined_triangles(corners);
}

}  // namespace bespoke
