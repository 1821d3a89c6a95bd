#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/asset/asset.h"
#include "bespoke/pipeline/fit_mapping.h"

namespace bespoke {

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

struct MakeMapInput {
  const TriangleMesh& source;
  const TriangleMesh& target;
  const Anchors& anchors;
  /// The source already fitted to the target, target frame, same connectivity: surface fitting is skipped.
  const TriangleMesh* fitted = nullptr;
  /// What the target was made of, if it is the surface of a point cloud: the record names that.
  const PointCloudSummary* target_cloud = nullptr;
  /// Names of the groups that the source's vertices belong to, one a vertex, for loose parts; called where
  /// there are any.
  std::function<std::vector<std::string>()> read_source_groups = nullptr;
};

struct MadeMap {
  Asset asset;
  FittedMapping fit;  ///< with fit.summary.bake
  double preview_seconds = 0;
};

/// The whole way from two models and their anchors to an asset: fit, bake, certificate, preview grids.
/// Throws InvalidInput, SolverError, MemoryLimitError, Interrupted.
MadeMap make_map(const MakeMapInput& input, const MakeMapOptions& options, const Progress& progress = {});

}  // namespace bespoke
