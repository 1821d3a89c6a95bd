#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "bespoke/pipeline/make_map.h"

namespace bespoke {

/// A map that was fitted and written, with the names of its files as a person knows them.
struct FitOutcome {
  const Problem& input;
  const MadeMap& made;
  std::string source, target, map;
  std::string fitted;                   ///< of a source that was registered already; else empty
  std::optional<std::uintmax_t> bytes;  ///< of the map's file; empty where that is no regular one
  double seconds = 0;
  std::string next;              ///< the command to type next
  bool names_tolerance = false;  ///< whether the user named one, which stored finite elements have no use for
};

/// At most ten lines for a person: that the map is not proved, if so, then what was registered, how near the
/// surfaces are, what has no counterpart and where, the anchors, the proof, the error against the tolerance,
/// the file, and the next command. Lengths have the name of their unit.
std::string fit_text(const FitOutcome& outcome);

}  // namespace bespoke
