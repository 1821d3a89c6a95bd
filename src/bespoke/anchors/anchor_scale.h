#pragma once

#include <optional>

#include "bespoke/anchors/anchors.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// What one side's anchors (3×n) are multiplied by, about the origin, to lie on their model, where they lie
/// off it as they are: one of both was scaled, or is in another unit. Nothing where they lie on it, where no
/// factor from 2 (or 1/2) on brings three quarters of them five times nearer, relative to what they span, and
/// for fewer than four. Throws InvalidInput when the mesh has no faces or something is not finite.
std::optional<double> anchor_scale(const TriangleMesh& model, const Points& anchors);

/// Throws InvalidInput naming the factor and the side where there is such a one.
void require_anchors_at_scale(const Anchors& anchors, const TriangleMesh& source, const TriangleMesh& target);

/// Multiplies the coordinates on the source by the first and those on the target by the second factor, and
/// lengths, which are told on the target, by the second.
void scale_anchors(Anchors& anchors, double source_scale, double target_scale);

}  // namespace bespoke
