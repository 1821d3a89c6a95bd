#include "bespoke/clearance/clearance_rule.h"

#include "bespoke/length.h"

namespace bespoke {

double ModelSizes::scale() const { return power_of_two_scale(target_diagonal / source_diagonal); }

std::optional<ClearanceRule> parse_clearance(std::string_view text, const ModelSizes& sizes) {
  if (text == "keep") return ClearanceRule{};
  if (text == "same") return ClearanceRule{.ease = std::nullopt, .same = true};
  const std::optional<Length> ease = parse_length(text, LengthRange::not_negative);
  if (!ease) return std::nullopt;
  return ClearanceRule{ease->in_mesh_units(sizes.source_diagonal) * (ease->percent ? sizes.scale() : 1)};
}

}  // namespace bespoke
