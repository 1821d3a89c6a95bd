#include "derived_map_options.h"

#include <cstdio>

#include "bespoke/asset/asset_io.h"
#include "commands.h"
#include "fit_warnings.h"
#include "help.h"
#include "output_files.h"

namespace bespoke::command {

namespace {

void warn_of_missed_tolerance(const RunContext& context, const DerivedMap& derived) {
  const BakeSummary& bake = derived.bake;
  if (bake.tolerance_met) return;
  char text[120];
  std::snprintf(text, sizeof text, "the largest error %.4g of the baked map exceeds the tolerance %.4g; ",
                bake.error.max, derived.asset.record.tolerance);
  const std::string relaxed = "it was relaxed in " + std::to_string(bake.relaxed.size()) +
                              " regions, to keep to 4.2 M voxels; a --tolerance of your own allows more";
  context.warn(text + (bake.relaxed.empty() ? "a smaller --tolerance allows finer voxels" : relaxed),
               Entry::tolerance_missed);
}

}  // namespace

BakeOptions DerivedMapOptions::bake(const DerivedTolerance& lengths) const {
  return derived_bake(tolerance, lengths, half ? ValuePrecision::half : ValuePrecision::single);
}

void add_derived_map_options(CLI::App& app, DerivedMapOptions& options,
                             const std::string& tolerance_description) {
  app.add_flag("--untrusted", options.untrusted, untrusted_help);
  begin_group(app, output_group);
  app.add_option("-o,--output", options.output, "Map to write")->required()->type_name("MAP.vdb");
  app.add_flag("--half", options.half, half_help);
  begin_group(app, quality_group);
  add_length_option(app, "--tolerance", options.tolerance, tolerance_description);
  add_run_options(app, options.run);
}

void write_derived_map(const DerivedMapOptions& options, const RunContext& context, const DerivedMap& derived,
                       const char* deviation) {
  OutputFiles outputs;
  outputs.write(options.output, [&](const auto& path) { write_asset(path, derived.asset); });
  outputs.keep();
  context.findings.figures = {{"deviation_max", derived.deviation.max},
                              {"bake_error_max", derived.bake.error.max},
                              {"tolerance_met", derived.bake.tolerance_met},
                              {"bijection", whole_certificate(derived.asset).is_bijection()},
                              {"voxels", voxel_count(derived.asset)}};
  warn_of_missing_certificate(context, whole_certificate(derived.asset));
  warn_of_missed_tolerance(context, derived);
  if (options.run.quiet) return;
  std::printf("%-12s %s\n", "bake", to_string(derived.bake).c_str());
  std::printf("%-12s %s\n", "certificate", to_string(whole_certificate(derived.asset)).c_str());
  std::printf("%-12s %s\n", deviation, to_string(derived.deviation).c_str());
  std::printf("%-12s %s\n", "written", options.output.c_str());
}

}  // namespace bespoke::command
