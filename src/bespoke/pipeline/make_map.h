#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "bespoke/asset/asset.h"
#include "bespoke/bake/bake_options.h"
#include "bespoke/progress.h"
#include "bespoke/registration/fit_options.h"
#include "bespoke/registration/problem.h"

namespace bespoke {

struct FittedMapping;

/// Default lengths as fractions of the source's bounding-box diagonal.
inline constexpr double default_lambda = 0.1;
inline constexpr double default_tolerance = 0.00025;
inline constexpr double default_fit_tolerance = 0.0001;
inline constexpr double default_contact_offset = 0.001;

/// Of the pyramids of a map, all steps together: some 25 MB of file.
inline constexpr std::size_t default_max_leaves = 8200;

struct MakeMapOptions {
  FitOptions fit;
  BakeOptions bake;
  std::optional<RotationPath> path;  ///< the flow of a chain, geodesic for one step when empty
  bool keep_exact = false;           ///< store the exact E as well (Asset::exact_map)
};

/// Options whose lengths are the default fractions above of `source_diagonal` (mesh units), except for lambda
/// `size_scale` times as much: they are measured on the target, which is about so many times as large
/// (power_of_two_scale, length.h).
MakeMapOptions default_options(double source_diagonal, double size_scale = 1);

struct MadeMap {
  Asset asset;
  std::shared_ptr<const ElasticChain> exact;  ///< E as it was before it was baked
  /// What every stage found (fit_mapping.h), with fit->summary.bake; its findings are in the record, too.
  std::shared_ptr<const FittedMapping> fit;
  double preview_seconds = 0;
};

/// The whole way from two models and their anchors to an asset: fit, bake, certificate, preview grids.
/// Throws InvalidInput, SolverError, MemoryLimitError, Interrupted.
MadeMap make_map(const Problem& problem, const MakeMapOptions& options, const Progress& progress = {});

}  // namespace bespoke
