#pragma once

#include "bespoke/mapping/elastic_chain.h"
#include "bespoke/mapping/mapping.h"

namespace bespoke {

/// The map as a chain whose steps the motion follows; null where it goes straight. Throws InvalidInput where
/// the order does not know the path `flow`.
const ElasticChain* followed_chain(const ElasticMap& elastic, const MotionOptions& motion);

}  // namespace bespoke
