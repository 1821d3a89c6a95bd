#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bespoke/asset/asset.h"
#include "bespoke/page/fit_findings.h"
#include "bespoke/pattern/read_pattern.h"
#include "bespoke/progress.h"
#include "bespoke/quality/mapping_quality.h"

namespace bespoke {

/// The flat pieces of one of the products.
struct ProductPattern {
  std::size_t product = 0;  ///< its number among the products of the ViewInput
  WrittenPattern pattern;
};

/// A map with what it joins and carries, to be looked at.
struct ViewInput {
  const Asset& asset;
  const TriangleMesh& source;  ///< the models that the map was made of
  const TriangleMesh& target;
  const std::vector<NamedProduct>& products;
  const FitFindings& findings;
  std::string title;
  std::string command;  ///< that made the page, as one would type it
  std::vector<ProductPattern> patterns = {};
  std::vector<Points> corrected = {};   ///< 3×n, target frame: where every product is at the end; or empty
  std::vector<std::string> notes = {};  ///< on what was done, for a person
};

struct ViewOptions {
  /// Triangles of all meshes together, > 0. Software rendering turns so many at some 30 frames a second.
  std::size_t max_faces = 200000;
  /// Samples of the map over space, all knots together, ≥ 8: what slices are drawn from.
  std::size_t space_samples = 60000;
};

/// The scene of the page `view` (README.md, "The scene"). Points of the meshes are carried exactly, then
/// rounded to 16 bits a coordinate: at every t they lie within 1e-5 of their mesh's bounding-box diagonal of
/// what `apply` writes, for the page composes Ψ(t) itself, from knots between which the elastic part is
/// straight. A product with a pattern is not decimated. Throws InvalidInput for models that are not valid,
/// options out of range, findings of another source, or patterns and places of other products; Interrupted.
std::string view_scene(const ViewInput& input, const ViewOptions& options = {},
                       const Progress& progress = {});

}  // namespace bespoke
