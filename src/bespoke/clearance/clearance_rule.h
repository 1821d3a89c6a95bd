#pragma once

#include <optional>
#include <string_view>

namespace bespoke {

/// Of the sizes of two models: what is a length of the source on the target (power_of_two_scale).
struct ModelSizes {
  double source_diagonal = 0;  ///< mesh units, > 0
  double target_diagonal = 0;  ///< mesh units, > 0
  double scale() const;        ///< a power of two
};

/// What clearance is required.
struct ClearanceRule {
  /// At least that distance, target's mesh units. Without it each point keeps the one that it had.
  std::optional<double> ease;
  /// Without an ease: places near the source come no farther away either, as far as bystanders may move.
  bool same = false;
};

/// What parse_clearance takes, for messages.
inline constexpr std::string_view clearance_grammar =
    "keep, same, a length such as 0.02, or a percentage of the source's diagonal such as 0.5%";

/// An ease in mesh units as it is named, in % of the source's diagonal by the scale of the sizes. Empty where
/// the text is none of the grammar.
std::optional<ClearanceRule> parse_clearance(std::string_view text, const ModelSizes& sizes);

}  // namespace bespoke
