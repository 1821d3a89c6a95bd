#pragma once

#include "bespoke/asset/asset.h"
#include "bespoke/bake/bake.h"

namespace bespoke {

/// A map made of other maps: an asset of its own, with its own bake, certificate and preview.
struct DerivedMap {
  Asset asset;
  BakeSummary bake;
  /// Of random points of the band, mesh units: after there and back (invert_map), between one map and two
  /// (compose_maps).
  Statistics deviation;
};

/// b→a of an asset a→b. Throws InvalidInput unless the asset's certificate says that its map is a bijection;
/// MemoryLimitError, Interrupted.
DerivedMap invert_map(const Asset& b_from_a, const BakeOptions& options, const Progress& progress = {});

enum class MeetingModels {
  must_be_the_same,  ///< by content hash
  may_differ,
};

/// a→c of a→b and b→c. Throws InvalidInput when the target of the first is not the source of the second.
DerivedMap compose_maps(const Asset& b_from_a, const Asset& c_from_b, const BakeOptions& options,
                        MeetingModels meeting, const Progress& progress = {});

}  // namespace bespoke
