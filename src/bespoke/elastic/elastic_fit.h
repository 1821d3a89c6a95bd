#pragma once

#include <cstddef>
#include <string>
#include <variant>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// What an elastic map is fitted to, source frame, mesh units. Methods that interpolate points take `sources`
/// and `targets`; methods that carry faces take the two meshes.
struct ElasticInput {
  const TriangleMesh& source;
  const Points& fitted;   ///< 3×n: the source's vertices on the target
  const Points& sources;  ///< 3×k: distinct places
  const Points& targets;  ///< 3×k: where they go
};

/// The part of an elastic map that holds everywhere, far from the models too.
enum class AffinePart {
  least_squares,  ///< the affine map nearest to the correspondences
  similarity,  ///< the nearest similarity: for steps of a change of pose, whose affine maps would shear space
};

struct ElasticOptions {
  double lambda = 0;  ///< effective distance around the source, > 0, mesh units
  double fit_tolerance =
      0;  ///< the multiscale methods stop refining below it, ≥ 0, mesh units; csrbf interpolates
  std::size_t max_memory = std::size_t{8} << 30;  ///< bytes
  /// csrbf and p-FFD have an affine part by construction and take no other.
  AffinePart affine_part = AffinePart::least_squares;
  bool guided = false;  ///< the multiscale methods meet guides in space too
  /// Finite elements: largest factor by which a volume may shrink relative to the affine part, > 1, no unit.
  double max_squeeze = 50;
  std::size_t max_nodes = 180'000;  ///< of finite elements, > 0
  bool give_up_blocked = false;     ///< finite elements: see FiniteElementOptions
  /// How many times as large lambda is around the fitted source, > 0: there the layers of a composition act.
  double growth = 1;
};

/// A number, or a list of them, that a method found, under the name that reports and assets give it.
struct Figure {
  std::string name;
  std::variant<double, std::size_t, std::vector<double>, std::vector<std::size_t>> value;
};

}  // namespace bespoke
