#pragma once

#include "bespoke/pipeline/fit_mapping.h"

namespace bespoke {

/// Registers the source to the target, sections IV.A to IV.C: Γ, H'_a and their confidence in `result`, with
/// what was found on the way. Surfaces end at seams (seams.h): models come without. Returns the anchors as
/// the fit took them, those of curves included. Throws as fit_mapping.
Anchors register_source(FittedMapping& result, const TriangleMesh& source, const TriangleMesh& target,
                        const Anchors& anchors, const FitOptions& options, const Progress& progress);

}  // namespace bespoke
