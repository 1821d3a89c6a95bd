#pragma once

#include "bespoke/registration/registration.h"

namespace bespoke {

/// Registers the source to the target, sections IV.A to IV.C, however Γ and H'_a are found: by anchors, with
/// curves, or by the surfaces alone. Surfaces end at seams (seams.h): models come without. Throws as
/// register_models.
Registration register_source(const Problem& problem, const FitOptions& options, const Progress& progress);

}  // namespace bespoke
