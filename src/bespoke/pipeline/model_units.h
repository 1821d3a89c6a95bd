#pragma once

#include <filesystem>
#include <string>

#include "bespoke/anchors/anchors.h"

namespace bespoke {

/// What says the units of a fit.
struct ModelUnits {
  std::string asked;           ///< the unit that the map shall have; empty when nobody says
  std::string source, target;  ///< as the models' files say; empty where they do not
  std::string source_name = "source", target_name = "target";  ///< for messages
};

/// The map's unit, and what the models' coordinates are multiplied by to be in it.
struct UnitPlan {
  std::string unit;  ///< empty where nothing says one
  double source_scale = 1, target_scale = 1;
};

/// The unit that is asked for, or else that of the anchors, of the source, of the target. Anchors that say
/// theirs are brought to it; those that say none are in the coordinates of their models' files and go with
/// these. Models that say none are taken as being in the map's unit. Throws InvalidInput, naming the factor,
/// where anchors and a model say two units and nobody asks for one, and for a unit that is not known by name
/// where another is to be converted.
UnitPlan bring_to_one_unit(const ModelUnits& units, Anchors& anchors);

}  // namespace bespoke
