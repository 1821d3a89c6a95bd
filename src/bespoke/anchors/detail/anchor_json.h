#pragma once

#include <string>

#include "bespoke/anchors/anchors.h"

namespace bespoke {

/// What read_anchors says of JSON. text: without a byte order mark; file: how messages call it. Throws
/// FormatError.
Anchors parse_anchor_json(const std::string& text, const std::string& file);

/// Names are printed and compared; a line break or a kilobyte in one would spoil every message and table.
/// Throws FormatError, which begins with `where`, as the next one.
void require_printable(const std::string& name, const std::string& where);

/// A pair has a weight or a σ: which of the two should hold cannot be known.
void require_one_accuracy(const AnchorPair& pair, const std::string& where);

}  // namespace bespoke
