#pragma once

#include <cstddef>
#include <optional>

#include "bespoke/pipeline/detail/map_fit.h"

namespace bespoke {

/// Whether divided_map can halve a step, by index: not one that is of a single layer. Throws
/// std::out_of_range.
bool is_divisible(const MapFit& fit, std::size_t step);

/// Whether the voxels of a step, by index, are foreseen to fold: its composition has more than two and a half
/// layers for each scale of the chain, which says how much steeper its motion is than one layer can be.
/// Throws std::out_of_range.
bool is_foreseen_to_fold(const MapFit& fit, std::size_t step);

/// The step to be halved, and what the fit was made of.
struct StepDivision {
  const MapProblem& problem;
  const FitOptions& options;
  std::size_t step = 0;
  bool leave_path = false;
};

/// The map with a step, by index, halved; the others stay as they are. A step becomes two along the path,
/// each of all scales and fitted anew; but where they would miss one vertex in twenty, or with `leave_path`,
/// a composition comes apart into two that are the same map together, as do all steps after that. Throws
/// InvalidInput where there is no such step, and as fit_map.
MapFit divided_map(const MapFit& fit, const StepDivision& division, const Progress& progress = {});

/// For a step that folded when baked: so many equal steps along the path in place of all there are, or
/// nothing where they would miss one vertex in twenty. count > 1.
std::optional<MapFit> refitted_in_steps(const MapFit& fit, const MapProblem& problem,
                                        const FitOptions& options, int count, const Progress& progress = {});

}  // namespace bespoke
