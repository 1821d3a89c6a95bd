#pragma once

#include <optional>

#include "bespoke/asset/asset.h"
#include "bespoke/bake/bake_options.h"
#include "bespoke/bake/bake_summary.h"
#include "bespoke/length.h"
#include "bespoke/progress.h"

namespace bespoke {

/// A map made of other maps: an asset of its own, with its own bake, certificate and preview.
struct DerivedMap {
  Asset asset;
  BakeSummary bake;
  /// Of random points of the band, mesh units: after a round trip (invert_map), between one map and two
  /// (compose_maps).
  Statistics deviation;
};

/// What the tolerance of a derived map is by default, and in percent of what, mesh units. Both are measured
/// where the map ends, on a model that may be of another size than those that the lengths were of
/// (power_of_two_scale, length.h; sizes by the sources that the maps show).
struct DerivedTolerance {
  double diagonal = 0;
  double otherwise = 0;
};
DerivedTolerance tolerance_of_inverse(const Asset& b_from_a);
DerivedTolerance tolerance_of_composed(const Asset& b_from_a, const Asset& c_from_b);

/// How a derived map is baked: to the tolerance that its user names; where none is named, to that by default
/// and with no more leaves than a fitted map has.
BakeOptions derived_bake(const std::optional<Length>& tolerance, const DerivedTolerance& lengths,
                         ValuePrecision precision);

/// b→a of an asset a→b. BakeOptions::max_leaves is for all steps together. Throws InvalidInput unless the
/// asset's certificate says that its map is a bijection, and for assets without previews; MemoryLimitError,
/// Interrupted.
DerivedMap invert_map(const Asset& b_from_a, const BakeOptions& options, const Progress& progress = {});

enum class MeetingModels {
  must_be_the_same,  ///< by content hash
  may_differ,
};

/// a→c of a→b and b→c. BakeOptions::max_leaves is for what is baked anew. Throws InvalidInput when the target
/// of the first is not the source of the second.
DerivedMap compose_maps(const Asset& b_from_a, const Asset& c_from_b, const BakeOptions& options,
                        MeetingModels meeting, const Progress& progress = {});

}  // namespace bespoke
