#include "bespoke/pipeline/model_units.h"

#include "bespoke/anchors/anchor_scale.h"
#include "bespoke/product/format_unit.h"

namespace bespoke {

UnitPlan bring_to_one_unit(const ModelUnits& units, Anchors& anchors) {
  UnitPlan plan;
  if (units.requested.empty()) {
    require_unit_of_anchors(units.source_name, units.source, anchors.unit);
    require_unit_of_anchors(units.target_name, units.target, anchors.unit);
  }
  for (const std::string& said : {units.requested, anchors.unit, units.source, units.target})
    if (plan.unit.empty()) plan.unit = said;
  const auto scale = [&](const std::string& unit) {
    return unit.empty() || unit == plan.unit ? 1 : required_unit_factor(unit, plan.unit);
  };
  plan.source_scale = scale(units.source);
  plan.target_scale = scale(units.target);
  if (anchors.unit.empty())
    scale_anchors(anchors, plan.source_scale, plan.target_scale);
  else
    scale_anchors(anchors, scale(anchors.unit), scale(anchors.unit));
  anchors.unit = plan.unit;
  return plan;
}

}  // namespace bespoke
