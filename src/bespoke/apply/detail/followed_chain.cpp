#include "bespoke/apply/detail/followed_chain.h"

#include "bespoke/error.h"

namespace bespoke {

const ElasticChain* followed_chain(const ElasticMap& elastic, const MotionOptions& motion) {
  if (motion.path != RotationPath::flow) return nullptr;
  if (motion.order != MappingOrder::elastic_first)
    throw InvalidInput("the flow of a map has one order: the elastic part first");
  const auto* chain = dynamic_cast<const ElasticChain*>(&elastic);
  return chain != nullptr && chain->steps().size() > 1 ? chain : nullptr;
}

}  // namespace bespoke
