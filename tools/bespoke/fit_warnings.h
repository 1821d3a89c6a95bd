#pragma once

#include "bespoke/anchors/anchors.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/pipeline/make_map.h"
#include "commands.h"

namespace bespoke::command {

/// What is odd about a pair, before the fit: anchors far from their models.
void warn_of_input(const RunContext& context, const TriangleMesh& source, const TriangleMesh& target,
                   const Anchors& anchors);

/// Where a map may fold: everything else that is said of it holds only where it does not.
void warn_of_missing_certificate(const RunContext& context, const Certificate& certificate);

/// Where a map is not as required: first of all that it is not certified, then anchors that were not
/// taken as given or are missed, a source that is not on the target, vertices that the map misses, a bake
/// that misses its tolerance.
void warn_of_misses(const RunContext& context, const Problem& input, const MakeMapOptions& options,
                    const MadeMap& made);

}  // namespace bespoke::command
