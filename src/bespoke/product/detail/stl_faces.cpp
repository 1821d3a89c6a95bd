#include <vector>

#include "bespoke/error.h"
#include "bespoke/mesh/equal_positions.h"
#include "bespoke/product/detail/face_formats.h"
#include "bespoke/product/detail/gathered_faces.h"
#include "bespoke/product/detail/stl_file.h"

namespace bespoke {
namespace {

/// One vertex for all corners at exactly one place, in the order of their first use; facets of which two
/// corners coincide are left out.
Product joined_facets(const Points& corners) {
  const EqualPositions equal = equal_positions(corners);
  std::vector<int> first(static_cast<std::size_t>(corners.cols()));
  for (std::size_t group = 0; group < equal.groups(); ++group)
    for (const int corner : equal.group(group))
      first[static_cast<std::size_t>(corner)] = equal.group(group).front();
  Product product;
  product.polygon_start.push_back(0);
  std::vector<int> vertex(first.size(), -1);
  std::vector<int> used;
  for (std::size_t facet = 0; facet + 2 < first.size(); facet += 3) {
    const int a = first[facet], b = first[facet + 1], c = first[facet + 2];
    if (a == b || b == c || c == a) continue;
    for (const int corner : {a, b, c}) {
      int& number = vertex[static_cast<std::size_t>(corner)];
      if (number < 0) {
        number = static_cast<int>(used.size());
        used.push_back(corner);
      }
      product.corners.push_back(number);
    }
    product.polygon_start.push_back(static_cast<int>(product.corners.size()));
  }
  product.vertices = corners(Eigen::all, used);
  return product;
}

Points binary_stl_corners(const InputFile& file, std::size_t facets) {
  GatheredFaces gathered(file.path());
  FacetCutter cutter;
  walk_blocks(
      file, stl_header_size, [&](const Window& window) { return cutter(window); },
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
  return joined_facets(corners);
}

}  // namespace bespoke
