#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "bespoke/pipeline/fit_mapping.h"

namespace bespoke {

/// E of the fitted vertices, the parts of which are separated (IV.D, IV.E): one map for models in about the
/// same pose, else a chain of them along surfaces between the two. `fitted` has everything but E and what
/// follows from it. Throws as fit_mapping.
void fit_elastic_map(FittedMapping& fitted, const TriangleMesh& source, const Anchors& anchors,
                     const FitOptions& options, const Progress& progress);

/// The same surfaces with an elastic map that meets these alone, or nothing if guides in space did not shape
/// it. Options as before.
std::optional<FittedMapping> refitted_without_guides(const FittedMapping& fitted, const TriangleMesh& source,
                                                     const Anchors& anchors, const FitOptions& options,
                                                     const Progress& progress = {});

/// |Γ(E(q)) − q'|, mesh units, one per pair.
std::vector<double> anchor_residuals(const FittedMapping& fitted, const Anchors& anchors);

/// Whether divide_step can halve a step, by index: not one that is of a single layer. Throws
/// std::out_of_range.
bool is_divisible(const FittedMapping& fitted, std::size_t step);

/// Whether the voxels of a step, by index, are foreseen to fold: its composition has more than two and a half
/// layers for each scale of the chain, which says how much steeper its motion is than one layer can be.
/// Throws std::out_of_range.
bool is_foreseen_to_fold(const FittedMapping& fitted, std::size_t step);

/// A map with a step, by index, halved; the others stay as they are. A step becomes two along the path, each
/// of all scales and fitted anew; but where they would miss one vertex in twenty, or with `leave_path`, a
/// composition comes apart into two that are the same map together, as do all steps after that. Options as
/// before. Throws InvalidInput where there is no such step, and as fit_mapping.
void divide_step(FittedMapping& fitted, const TriangleMesh& source, const Anchors& anchors,
                 const FitOptions& options, std::size_t step, bool leave_path = false,
                 const Progress& progress = {});

/// For a step that folded when baked: so many equal steps along the path in place of all there are, or
/// nothing where they would miss one vertex in twenty. Options as before; count > 1.
std::optional<FittedMapping> refitted_in_steps(const FittedMapping& fitted, const TriangleMesh& source,
                                               const Anchors& anchors, const FitOptions& options, int count,
                                               const Progress& progress = {});

}  // namespace bespoke
