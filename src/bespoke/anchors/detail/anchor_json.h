#pragma once

#include <set>
#include <string>
#include <vector>

#include "bespoke/anchors/anchors.h"
#include "bespoke/error.h"

namespace bespoke {

/// What read_anchors says of JSON. text: without a byte order mark; file: how messages call it. Throws
/// FormatError.
Anchors parse_anchor_json(const std::string& text, const std::string& file);

/// Names are printed and compared; a line break or a kilobyte in one would spoil every message and table.
/// Throws FormatError, which begins with `where`, as the next one.
void require_printable(const std::string& name, const std::string& where);

/// Models' coordinates are finite in single precision, and products of anchors' beyond are not finite at all.
/// Throws FormatError, which begins with `where`.
void require_coordinate(double number, const std::string& where);

/// For pairs and patches; `kind` is their plural.
template <class Named>
void require_distinct_names(const std::vector<Named>& all, const std::string& kind, const std::string& file) {
  std::set<std::string> seen;
  for (const Named& each : all)
    if (!each.name.empty() && !seen.insert(each.name).second)
      throw FormatError(file + ": two " + kind + " are named \"" + each.name +
                        "\"; names must differ or be empty");
}

/// A pair has a weight or a σ: which of the two should hold cannot be known.
void require_one_accuracy(const AnchorPair& pair, const std::string& where);

}  // namespace bespoke
