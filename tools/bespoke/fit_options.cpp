#include "fit_options.h"

#include "bespoke/elastic/elastic_methods.h"
#include "bespoke/product/product_io.h"
#include "bespoke/surface_fit/surface_fit_methods.h"
#include "commands.h"
#include "help.h"
#include "length_option.h"
#include "memory_option.h"
#include "name_option.h"
#include "pose_option.h"

namespace bespoke::command {
namespace {

/// "… (default: 0.1%)".
std::string defaulted(const std::string& text, const std::string& value) {
  return text + " (default: " + value + ")";
}

/// Of an option whose default is one of the names of a table.
template <class Table, class Value>
std::string defaulted(const std::string& text, const Table& names, Value value) {
  return defaulted(text, std::string(name_of(names, value)));
}

/// Of a length on the source whose default is a fraction of its diagonal.
std::string source_length(const std::string& text, double fraction) {
  return defaulted(text + ", mesh units or % of the source's bounding-box diagonal", percentage(fraction));
}

/// Of a length on the target.
std::string target_length(const std::string& text, double fraction) {
  return source_length(text, fraction) + ", scaled with the target's size in powers of two";
}

void add_input_options(CLI::App& fit, FitArguments& arguments) {
  begin_group(fit, input_group);
  fit.add_option("SOURCE", arguments.source,
                 "Reference model that products are designed around: " + read_product_endings())
      ->required();
  fit.add_option("TARGET", arguments.target, "Reference model that products are to fit")->required();
  add_pose_option(fit, arguments.pose, "skinned glTF models");
  fit.add_option("--anchors", arguments.anchors,
                 "Anchors (landmarks): pairs of corresponding points in one file: .json (also curves and "
                 "patches), .csv, or .txt of vertex numbers; .pp, .fcsv, .mrk.json, .pts and .wrap.json have "
                 "one file a side, which `anchors convert` joins (default: none; models in similar pose are "
                 "aligned by their surfaces)")
      ->type_name("FILE");
  add_length_option(
      fit, "--anchor-sigma", arguments.anchor_sigma,
      "Accuracy of anchors that have neither a sigma nor a weight of their own: standard deviation of a "
      "coordinate, mesh units or % of the diagonal; 0 meets them exactly (default: estimated from their "
      "distance to the target)",
      LengthRange::not_negative);
  fit.add_flag("--add-corners", arguments.add_corners,
               "Add the eight corners of the bounding boxes of the two models, aligned, as anchors");
  fit.add_option("--fitted", arguments.fitted,
                 "The source already registered to the target (same connectivity); skips registration")
      ->type_name("MESH");
  fit.add_flag("--any-size", arguments.any_size,
               "Accept models that differ by more than eight times in size, which are refused otherwise as "
               "being in two units: the map then goes from one unit to the other");
  fit.add_flag(
      "--any-anchors", arguments.any_anchors,
      "Accept anchors that miss a model by a factor, which are refused otherwise as if one of both had "
      "been scaled");
  fit.add_option(
         "--unit", arguments.unit,
         "Unit of the map: mm, cm, m, in …; models (glTF, 3MF) and anchors whose files say another are "
         "converted, others are taken as being in it (default: what the anchors, the source or the target "
         "say)")
      ->type_name("UNIT");
  fit.add_flag("--as-given", arguments.as_given,
               "Take the models as they are: by default edges that a file cuts open at the same places are "
               "joined, and a target that is inside out is turned right side out");
}

void add_output_options(CLI::App& fit, FitArguments& arguments) {
  begin_group(fit, output_group);
  fit.add_option("-o,--output", arguments.output, "Map to write")->required()->type_name("MAP.vdb");
  fit.add_option("--report", arguments.report,
                 "Write residuals, iterations, seconds, counts and memory as JSON")
      ->type_name("FILE");
  fit.add_option("--html", arguments.html,
                 "Write a page that shows the map, as `view` does, and an index of pages")
      ->type_name("DIR");
  fit.add_option("--fitted-out", arguments.fitted_out, "Write the source as registered to the target")
      ->type_name("MESH");
  fit.add_option("--confidence-out", arguments.confidence_out,
                 "Write the confidence of every source vertex in its counterpart, 0 to 1, one line a vertex")
      ->type_name("FILE");
  fit.add_flag("--keep-exact", arguments.keep_exact,
               "Also store what `apply --exact` needs to evaluate the map without its grids");
  fit.add_flag("--half", arguments.half, half_help);
}

void add_quality_options(CLI::App& fit, FitArguments& arguments) {
  begin_group(fit, quality_group);
  add_length_option(
      fit, "--tolerance", arguments.tolerance,
      target_length(
          "Largest difference between the stored and the exact map, of methods that are baked (finite "
          "elements are stored as they are fitted)",
          default_tolerance));
  add_length_option(fit, "--lambda", arguments.lambda,
                    source_length("Effective distance: the elastic part reaches as far from the source "
                                  "(1.4 times with --guides and --elastic diffeomorphic or multiscale)",
                                  default_lambda));
  fit.add_flag("--require-certified", arguments.require_certified,
               "Write nothing unless the map is proved to be one-to-one (a bijection of space)");
  fit.add_flag("--strict", arguments.strict,
               "Meet every vertex to --fit-tolerance and the map to --tolerance, however much that squeezes "
               "space, or refuse where memory does not suffice: --elastic diffeomorphic without a limit of "
               "voxels. By default vertices give way where space would be squeezed more than --max-squeeze, "
               "and are listed");
  fit.add_option("--max-squeeze", arguments.max_squeeze,
                 defaulted("finite-elements: largest factor by which a volume may shrink against the affine "
                           "part, in each step of a map; vertices that need more are missed and listed",
                           CLI::detail::to_string(default_options(1).fit.max_squeeze)))
      ->check(CLI::Range(1.01, 1e9))
      ->type_name("FACTOR");
  add_length_option(fit, "--fit-tolerance", arguments.fit_tolerance,
                    target_length("How far the map may miss the registered source before it is refined there",
                                  default_fit_tolerance));
  add_length_option(fit, "--voxel-size", arguments.voxel_size,
                    "Bake one uniform level of this voxel size, mesh units or % of the diagonal (default: "
                    "nested levels that meet --tolerance)");
}

void add_registration_options(CLI::App& fit, FitArguments& arguments) {
  const SurfaceFitOptions defaults = default_options(1).fit.surface_fit;
  add_name_option(
      fit, "--surface-fit", arguments.surface_fit, surface_fits,
      defaulted("Non-rigid registration of the source to the target", surface_fits, defaults.method));
  add_name_option(
      fit, "--boundaries", arguments.boundaries, boundary_rules,
      defaulted("deformation-graph: whether open boundaries of the source meet the target's; free when the "
                "models were cut at different places",
                boundary_rules, defaults.boundaries));
  fit.add_option("--max-stretch", arguments.max_stretch,
                 defaulted("deformation-graph: where a length on the source would grow or shrink by a larger "
                           "factor than in its coarse deformation, vertices follow their neighbours instead",
                           CLI::detail::to_string(defaults.max_stretch)))
      ->check(CLI::Range(1.01, 1e6))
      ->type_name("FACTOR");
  add_length_option(
      fit, "--contact-offset", arguments.contact_offset,
      target_length("Contact offset: touching parts of the target are separated by it (0: they are not)",
                    default_contact_offset),
      LengthRange::not_negative);
}

void add_method_options(CLI::App& fit, FitArguments& arguments) {
  const MakeMapOptions defaults = default_options(1);
  begin_group(fit, method_group);
  add_registration_options(fit, arguments);
  add_name_option(
      fit, "--elastic", arguments.elastic, elastic_methods,
      defaulted("How the registration is extended to space", elastic_methods, defaults.fit.elastic));
  add_name_option(fit, "--guides", arguments.guides, guided_maps,
                  defaulted("Maps that move space off the surface along with it as a rigid "
                            "body, so that a loose sleeve turns with its arm; steps are those of chains",
                            guided_maps, defaults.fit.guides));
  fit.add_option(
         "--steps", arguments.steps,
         "Steps of the chain of maps (default: 1 for models in about the same pose, else by the largest turn "
         "of a part; more where fewer would hold up the fit or miss vertices)")
      ->check(CLI::Range(1, 100))
      ->type_name("N");
  add_name_option(fit, "--path", arguments.path, rotation_paths,
                  "How the motion goes with t; stored in the map (default: flow for a map of several steps, "
                  "else geodesic)");
  add_name_option(fit, "--nodes", arguments.nodes, node_values,
                  defaulted("Methods that are baked: values at the nodes of nested levels, the map's own, or "
                            "values between which interpolation errs equally to either side, in a third "
                            "fewer voxels",
                            node_values, defaults.bake.nodes));
  fit.add_flag(
      "--paper", arguments.paper,
      "The printed method: --surface-fit laplacian with nothing added to Eq. 11-15, --elastic csrbf, --path "
      "euler, --steps 1, --contact-offset 0, --nodes sampled, --as-given, and anchors met exactly that have "
      "neither a sigma nor a weight");
}

}  // namespace

void add_fit_options(CLI::App& fit, FitArguments& arguments) {
  set_short_help(fit, {"anchors", "anchor-sigma", "any-size", "output", "report", "html", "verbose", "quiet",
                       "tolerance", "lambda", "require-certified", "threads"});
  add_input_options(fit, arguments);
  add_output_options(fit, arguments);
  add_quality_options(fit, arguments);
  add_method_options(fit, arguments);
  add_run_options(fit, arguments.run);
  begin_group(fit, output_group);
  fit.add_flag("-v,--verbose", arguments.verbose, "Print what every stage found instead of a summary")
      ->excludes("--quiet");
  begin_group(fit, jobs_group);
  add_memory_option(fit, arguments.max_memory,
                    "Memory that a stage may take, for instance 4GiB (default: 8GiB)");
}

}  // namespace bespoke::command
