#include "bespoke/page/detail/input_quality.h"

namespace bespoke {

MappingQuality input_quality(const ViewInput& input, const ElasticChain& chain, const Progress& progress) {
  const std::vector<AnchorRecord>& anchors = input.asset.record.anchors;
  const auto count = static_cast<Eigen::Index>(anchors.size());
  Points sources(3, count), targets(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    sources.col(i) = anchors[static_cast<std::size_t>(i)].a;
    targets.col(i) = anchors[static_cast<std::size_t>(i)].b;
  }
  const RigidTransform& rigid = input.asset.target_from_source;
  return mapping_quality({input.source, input.target, chain, rigid, sources, targets, input.products}, {},
                         progress);
}

std::vector<std::string> product_names(const ViewInput& input) {
  std::vector<std::string> names;
  for (const NamedProduct& product : input.products) names.push_back(product.name);
  return names;
}

}  // namespace bespoke
