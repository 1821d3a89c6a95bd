#include "bespoke/pipeline/open_map.h"

#include <utility>
#include <vector>

#include "bespoke/asset/model_distances.h"
#include "bespoke/certificate/inverse.h"
#include "bespoke/elastic/exact_map_io.h"
#include "bespoke/error.h"
#include "bespoke/lattice/baked_map.h"
#include "bespoke/mapping/scaled_map.h"

namespace bespoke {

std::shared_ptr<const ElasticMap> inverse_map(std::vector<MapStep> steps,
                                              const RigidTransform& target_from_source) {
  for (const MapStep& step : steps)
    if (!step.certificate.is_bijection())
      throw InvalidInput("the map is not certified as a bijection, so it has no inverse");
  std::vector<std::shared_ptr<const ElasticMap>> inverse_steps;
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
    const auto baked = std::make_shared<BakedMap>(step->affine, std::move(step->pyramid));
    // The inverse refers to the baked map, which therefore goes last.
    inverse_steps.emplace_back(new InverseMap(*baked, target_from_source), [baked](const ElasticMap* map) {
      delete static_cast<const InverseMap*>(map);
    });
  }
  return std::make_shared<ElasticChain>(std::move(inverse_steps));
}

OpenedMap in_other_unit(const OpenedMap& map, double scale) {
  if (scale == 1) return map;
  OpenedMap other = map;
  other.elastic = in_other_unit(map.elastic, scale);
  other.target_from_source = in_other_unit(map.target_from_source, scale);
  other.source_diagonal /= scale;
  other.model_box = Box(map.model_box.min() / scale, map.model_box.max() / scale);
  other.target_diagonal /= scale;
  return other;
}

OpenedMap open_map(const std::filesystem::path& path, MapForm form, const ReadAssetOptions& options) {
  Asset asset = read_asset(path, options);
  OpenedMap map{nullptr,
                asset.target_from_source,
                asset.path,
                asset.record.source.box.diagonal().norm(),
                asset.record.source.hash,
                asset.record.target.hash,
                asset.record.unit,
                form == MapForm::inverse ? asset.record.target.box : asset.record.source.box,
                asset.record.target.box.diagonal().norm(),
                model_distances(asset)};
  switch (form) {
    case MapForm::grids:
      map.elastic = std::make_shared<ElasticChain>(loaded_chain(std::move(asset.steps)));
      break;
    case MapForm::exact:
      map.elastic = stored_exact_map(path, asset);
      break;
    case MapForm::inverse:
      if (!whole_certificate(asset).is_bijection())
        throw InvalidInput(path.string() + ": is not certified as a bijection, so it has no inverse");
      map.elastic = inverse_map(std::move(asset.steps), asset.target_from_source);
      map.target_from_source = inverse(asset.target_from_source);
      if (map.distances)
        map.distances = std::make_shared<const ModelDistances>(
            ModelDistances{map.distances->target, map.distances->source});
      break;
  }
  return map;
}

std::shared_ptr<const ElasticMap> stored_exact_map(const std::filesystem::path& path, const Asset& asset) {
  if (asset.exact_map.empty())
    throw InvalidInput(path.string() + ": holds no exact map; make it with `bespoke fit --keep-exact`");
  try {
    return parse_exact_map(asset.exact_map);
  } catch (const FormatError& error) {
    throw FormatError(path.string() + ": " + error.what());
  }
}

}  // namespace bespoke
