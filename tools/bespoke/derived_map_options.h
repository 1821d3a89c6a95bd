#pragma once

#include <optional>
#include <string>

#include "bespoke/pipeline/derive_map.h"
#include "length_option.h"
#include "planned_run.h"

namespace bespoke::command {

/// What every subcommand takes that makes a map out of others.
struct DerivedMapOptions {
  std::string output;
  std::optional<Length> tolerance;
  bool half = false;
  bool untrusted = false;
  RunOptions run;

  /// The tolerance as given, or by default.
  BakeOptions bake(const DerivedTolerance& lengths) const;
};

void add_derived_map_options(CLI::App& app, DerivedMapOptions& options,
                             const std::string& tolerance_description);

/// Writes the asset and prints its summaries; `deviation` names what the map's deviation is.
void write_derived_map(const DerivedMapOptions& options, const RunContext& context, const DerivedMap& derived,
                       const char* deviation);

}  // namespace bespoke::command
