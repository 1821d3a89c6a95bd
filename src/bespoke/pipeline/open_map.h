#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "bespoke/asset/asset_io.h"
#include "bespoke/mapping/elastic_map.h"
#include "bespoke/mapping/mapping.h"

namespace bespoke {

/// Which map of an asset carries products.
enum class MapForm {
  grids,    ///< what is stored, in its fastest form
  exact,    ///< the exact map that `fit --keep-exact` stored
  inverse,  ///< back from the target, through the cells of a certified map
};

struct ModelDistances;

/// A map as products are carried through it. Any number of threads may share one.
struct OpenedMap {
  std::shared_ptr<const ElasticMap> elastic;
  RigidTransform target_from_source;  ///< turned round in the inverse
  RotationPath path = RotationPath::geodesic;
  double source_diagonal = 0;  ///< of the source's bounding box, mesh units
  /// Of the two models of the asset (content_hash), whichever way the map leads.
  std::string source_hash = {}, target_hash = {};
  std::string unit = {};  ///< of all lengths, "unknown" when none was stated
  Box model_box = {};     ///< of the model that products are around: the source, the target of an inverse
  double target_diagonal = 0;  ///< of the target's bounding box, mesh units
  /// Of the models, in the map's unit, whichever way it leads; null where the file lacks them, and of a part.
  std::shared_ptr<const ModelDistances> distances = {};
};

/// The map for points in another unit, of which one is `scale` > 0 units of the map.
OpenedMap in_other_unit(const OpenedMap& map, double scale);

/// Throws as read_asset; InvalidInput when the asset has no such map.
OpenedMap open_map(const std::filesystem::path& path, MapForm form = MapForm::grids,
                   const ReadAssetOptions& options = {});

/// The inverse of a map through its own cells, in the target frame: Ψ⁻¹ = Γ⁻¹ ∘ this. Throws InvalidInput
/// unless every step is certified as a bijection.
std::shared_ptr<const ElasticMap> inverse_map(std::vector<MapStep> steps,
                                              const RigidTransform& target_from_source);

/// The exact map that `fit --keep-exact` stored in the asset read from `path`. Throws InvalidInput when there
/// is none, FormatError for bytes that are not one.
std::shared_ptr<const ElasticMap> stored_exact_map(const std::filesystem::path& path, const Asset& asset);

}  // namespace bespoke
