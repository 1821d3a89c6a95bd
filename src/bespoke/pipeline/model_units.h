#pragma once

#include <filesystem>
#include <string>

#include "bespoke/anchors/anchors.h"

namespace bespoke {

/// The units of a fit.
struct ModelUnits {
  std::string requested;       ///< the map's unit; empty if not given
  std::string source, target;  ///< of the models' files; empty where these have none
  std::string source_name = "source", target_name = "target";  ///< for messages
};

/// The map's unit, and what the models' coordinates are multiplied by to be in it.
struct UnitPlan {
  std::string unit;  ///< empty if none is given
  double source_scale = 1, target_scale = 1;
};

/// The requested unit, or else that of the anchors, of the source, of the target. Anchors with a unit are
/// converted to it; those without one are in the coordinates of their models' files and go with these. Models
/// without a unit are taken as being in the map's. Throws InvalidInput, naming the factor, where anchors and
/// a model have two units and none is requested, and for a unit of unknown name that is to be converted.
UnitPlan bring_to_one_unit(const ModelUnits& units, Anchors& anchors);

}  // namespace bespoke
