#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bespoke/pipeline/open_map.h"
#include "map_models.h"

namespace bespoke::command {

struct RunContext;

/// Finds products that penetrate the target of their map, where both of its models are known.
class PenetrationCheck {
 public:
  /// The files of the models; nothing is checked where one is empty.
  PenetrationCheck(const std::string& source, const std::string& target);
  ~PenetrationCheck();

  /// A warning, or nothing. map: in its own unit; unit: of the product's coordinates, as product_scale takes
  /// it; pose: of a skinned one. The first call reads the models. Throws InvalidInput for models that the map
  /// was not made of, and whatever reading throws.
  std::string operator()(const std::string& product, const OpenedMap& map, const std::string& unit,
                         ModelPose pose = ModelPose::shown);

 private:
  struct Models;
  std::string source_, target_;
  std::unique_ptr<const Models> models_;
};

/// Warns of the products that penetrate their target. corrected: where they are in place of where the map
/// takes them, 3×n each, in the order of the products; or empty.
void warn_of_penetration(const RunContext& context, const MapModels& models,
                         const std::vector<Points>& corrected = {});

}  // namespace bespoke::command
