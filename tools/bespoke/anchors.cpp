#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "bespoke/anchor_checks/contradicting_anchors.h"
#include "bespoke/anchors/anchor_accuracy.h"
#include "bespoke/anchors/anchor_audit.h"
#include "bespoke/anchors/anchor_files.h"
#include "bespoke/anchors/anchor_placement.h"
#include "bespoke/anchors/anchor_scale.h"
#include "bespoke/cloud/target_model.h"
#include "bespoke/error.h"
#include "bespoke/output_stream.h"
#include "bespoke/pipeline/model_units.h"
#include "bespoke/product/format_unit.h"
#include "bespoke/registration/anchor_suggestions.h"
#include "bespoke/rigid/rigid_alignment.h"
#include "commands.h"
#include "help.h"
#include "length_option.h"
#include "output_files.h"
#include "pose_option.h"
#include "run_options.h"
#include "standard_output.h"

namespace bespoke::command {
namespace {

/// The models that an anchors file belongs to, where they are given.
struct ModelArguments {
  std::string source;
  std::string target;
  std::optional<ModelPose> pose;
};

struct Models {
  std::optional<TriangleMesh> source;
  std::optional<TriangleMesh> target;
};

void add_model_options(CLI::App& app, ModelArguments& arguments, const std::string& why) {
  app.add_option("--source", arguments.source, "Source model: " + why)->type_name("MESH");
  app.add_option("--target", arguments.target, "Target model: " + why)->type_name("MESH");
  add_pose_option(app, arguments.pose, "skinned glTF models");
}

Models read_models(const ModelArguments& arguments) {
  const ModelPose pose = arguments.pose.value_or(ModelPose::shown);
  Models models;
  if (!arguments.source.empty()) models.source = read_source_model(arguments.source, pose).mesh;
  if (!arguments.target.empty()) models.target = read_target(arguments.target, pose).mesh;
  return models;
}

/// Models and anchors brought to one unit, as a fit takes them.
struct InOneUnit {
  Models models;
  Anchors anchors;
  UnitPlan plan;
};

InOneUnit in_one_unit(const Models& models, const Anchors& anchors, const ModelArguments& arguments) {
  InOneUnit result{models, anchors, {}};
  result.plan = bring_to_one_unit({anchors.unit, unit_of_format(arguments.source),
                                   unit_of_format(arguments.target), arguments.source, arguments.target},
                                  result.anchors);
  if (result.models.source) result.models.source->vertices *= result.plan.source_scale;
  if (result.models.target) result.models.target->vertices *= result.plan.target_scale;
  return result;
}

AnchorFileOptions file_options(const Models& models, PatientSystem system = PatientSystem::lps) {
  return {models.source ? &*models.source : nullptr, models.target ? &*models.target : nullptr, system};
}

std::vector<std::filesystem::path> as_paths(const std::vector<std::string>& names) {
  return {names.begin(), names.end()};
}

std::string counted(std::size_t count, const std::string& one, const std::string& more) {
  return std::to_string(count) + ' ' + (count == 1 ? one : more);
}

/// What a file has beside pairs; empty for nothing.
std::string lines_and_parts(const Anchors& anchors) {
  std::string text;
  if (!anchors.curves.empty()) text = counted(anchors.curves.size(), "curve", "curves");
  if (!anchors.patches.empty())
    text += (text.empty() ? "" : " and ") + counted(anchors.patches.size(), "patch", "patches");
  return text;
}

/// What a file of this format holds of the anchors, and what it does not.
std::string written(const Anchors& anchors, AnchorFormat format) {
  Anchors kept = anchors;
  if (!has_curves(format)) kept.curves.clear();
  if (format != AnchorFormat::json) kept.patches.clear();
  std::string text = counted(kept.pairs.size(), "pair", "pairs");
  if (const std::string others = lines_and_parts(kept); !others.empty()) text += " and " + others;
  if (const std::string lost = left_out(anchors, format); !lost.empty())
    text += "; left out, since the format has no place for it: " + lost;
  return text;
}

/// Standard output, a pipe or a device, whose name tells no format, takes this project's own.
bool takes_any_format(const std::vector<std::string>& outputs) {
  const std::filesystem::path output = outputs.front();
  return is_standard_output(output) || (is_stream(output) && !output.has_extension());
}

AnchorFormat written_format(const std::vector<std::string>& outputs) {
  return takes_any_format(outputs) ? AnchorFormat::json : anchor_format_of(outputs.front());
}

void write_anchors(const std::vector<std::string>& outputs, const Anchors& anchors,
                   const AnchorFileOptions& options) {
  if (!takes_any_format(outputs)) return write_anchor_files(as_paths(outputs), anchors, options);
  if (outputs.size() > 1)
    throw CLI::ValidationError("-o", outputs.front() + " takes both sides; give it alone");
  OutputFiles files;
  files.write_text(outputs.front(), anchors_json(anchors));
  files.keep();
}

// ---- convert

struct ConvertArguments {
  std::vector<std::string> inputs;
  std::vector<std::string> outputs;
  std::string coordinates = "LPS";
  ModelArguments models;
};

void convert(const ConvertArguments& arguments) {
  require_safe_outputs(as_paths(arguments.inputs), as_paths(arguments.outputs));
  const Models models = read_models(arguments.models);
  const AnchorFileOptions options =
      file_options(models, arguments.coordinates == "RAS" ? PatientSystem::ras : PatientSystem::lps);
  const Anchors anchors = read_anchor_files(as_paths(arguments.inputs), options);
  write_anchors(arguments.outputs, anchors, options);
  std::cout << written(anchors, written_format(arguments.outputs)) << '\n';
}

void add_convert(CLI::App& app) {
  auto arguments = std::make_shared<ConvertArguments>();
  CLI::App* command =
      app.add_subcommand("convert", "Convert anchors, and curves, to and from formats of other programs");
  begin_group(*command, input_group);
  command
      ->add_option("INPUT", arguments->inputs,
                   "Anchors; where a format has one file for each model, the source's and the target's")
      ->required()
      ->expected(1, 2);
  add_model_options(*command, arguments->models, "needed for .wrap.json and .txt, which name its vertices");
  command
      ->add_option("--coordinates", arguments->coordinates,
                   "Patient coordinates of the models, for 3D Slicer's files")
      ->check(CLI::IsMember({"LPS", "RAS"}))
      ->capture_default_str();
  begin_group(*command, output_group);
  command->add_option("-o,--output", arguments->outputs, "File or files to write; endings give the formats")
      ->required()
      ->expected(1, 2);
  command->footer(
      "Endings: .json and .csv (both models in one file), .pp (MeshLab), .mrk.json and .fcsv (3D Slicer), "
      ".pts "
      "(Landmark Editor), .wrap.json ([triangle, u, v] lists), .txt (two vertex numbers a line, from 0). "
      "Curves "
      "go into .json and .mrk.json, patches into .json; what a format has no place for is listed.\n\n"
      "Examples:\n"
      "  bespoke anchors convert woman.pp man.pp -o anchors.json\n"
      "  bespoke anchors convert anchors.json -o woman.mrk.json man.mrk.json");
  command->callback([arguments] { convert(*arguments); });
}

// ---- audit

struct AuditArguments {
  std::vector<std::string> inputs;
  ModelArguments models;
};

/// Prints a finding; whether there was one.
bool print(const std::string& finding) {
  if (!finding.empty()) std::cout << finding << '\n';
  return !finding.empty();
}

bool print_far(const char* side, const std::optional<TriangleMesh>& model, const Points& points) {
  if (!model) return false;
  const std::optional<AnchorPlacement> far = far_placement(*model, points);
  return far && print(std::string(side) + ": " + to_string(*far) + "; another unit?");
}

/// What no fit can begin with: points on a line or at one place.
bool print_undetermined(const Anchors& anchors) {
  constexpr std::size_t min_pairs = 3;  // fewer may be joined by more
  if (anchors.pairs.size() < min_pairs) return false;
  try {
    align_rigidly(source_points(anchors), target_points(anchors), spline_weights(anchors));
  } catch (const InvalidInput& error) {
    return print(error.what());
  }
  return false;
}

void audit(const AuditArguments& arguments) {
  const Models given = read_models(arguments.models);
  const auto [models, anchors, plan] = in_one_unit(
      given, read_anchor_files(as_paths(arguments.inputs), file_options(given)), arguments.models);
  const AnchorAudit found = audit_anchors(anchors);
  std::cout << anchors.pairs.size() << " pairs";
  if (const std::string others = lines_and_parts(anchors); !others.empty()) std::cout << " and " << others;
  if (found.typical_distance)
    std::cout << ", each pair within " << *found.typical_distance << " (median) of where the others put it\n";
  else
    std::cout << ", too few pairs to be judged by each other\n";
  bool is_suspect = print_undetermined(anchors);
  is_suspect |= print(to_string(found, anchors));
  is_suspect |= print(to_string(swapped_anchors(anchors), anchors));
  is_suspect |= print(to_string(contradicting_anchors(anchors), anchors));
  is_suspect |= print_far("source", models.source, source_points(anchors));
  is_suspect |= print_far("target", models.target, target_points(anchors));
  if (models.source && models.target) {
    const AnchorAccuracy accuracy = estimate_anchor_sigmas(anchors, *models.source, *models.target).accuracy;
    is_suspect |= print(to_string(accuracy, anchors));
    is_suspect |= print(off_target(accuracy, *models.target));
    is_suspect |= print(exchanged_sides(anchors, *models.source, *models.target));
  }
  if (!is_suspect) std::cout << "nothing is suspicious\n";
}

void add_audit(CLI::App& app) {
  auto arguments = std::make_shared<AuditArguments>();
  CLI::App* command = app.add_subcommand(
      "audit", "Find suspicious anchors without a fit; `fit` also tests suspects on the surfaces");
  begin_group(*command, input_group);
  command->add_option("INPUT", arguments->inputs, "Anchors, in any format of `anchors convert`")
      ->required()
      ->expected(1, 2);
  add_model_options(*command, arguments->models, "more is checked with both");
  command->footer(
      "Examples:\n"
      "  bespoke anchors audit anchors.json\n"
      "  bespoke anchors audit anchors.json --source woman.obj --target man.obj");
  command->callback([arguments] { audit(*arguments); });
}

// ---- suggest

struct SuggestArguments {
  ModelArguments models;
  std::vector<std::string> anchors;
  std::vector<std::string> outputs;
  std::size_t count = SuggestionOptions().count;
  std::optional<Length> tolerance;
  RunOptions run;
};

// Of the target's diagonal: pairs that people pick are no more accurate.
constexpr double surest = 1e-3;

void print(const SuggestedAnchor& suggestion) {
  const auto place = [](const Vector3& x) {
    std::ostringstream text;
    text << '(' << x[0] << ", " << x[1] << ", " << x[2] << ')';
    return text.str();
  };
  std::printf(
      "%s: %s on the source, %s on the target, sigma %.4g; the fits are %.4g apart, confidence %.2f\n",
      suggestion.pair.name.c_str(), place(suggestion.pair.a).c_str(), place(suggestion.pair.b).c_str(),
      *suggestion.pair.sigma, suggestion.uncertainty, suggestion.confidence);
}

void suggest(const SuggestArguments& arguments, const Progress& progress) {
  std::vector<std::filesystem::path> inputs = as_paths(arguments.anchors);
  inputs.insert(inputs.end(), {arguments.models.source, arguments.models.target});
  require_safe_outputs(inputs, as_paths(arguments.outputs));
  const Models models = read_models(arguments.models);
  const AnchorFileOptions options = file_options(models);
  Anchors anchors;
  if (!arguments.anchors.empty()) anchors = read_anchor_files(as_paths(arguments.anchors), options);
  const InOneUnit fitted = in_one_unit(models, anchors, arguments.models);
  const double size = diagonal(fitted.models.target->vertices);
  const double tolerance = arguments.tolerance ? arguments.tolerance->in_mesh_units(size) : surest * size;
  const std::vector<SuggestedAnchor> suggestions = suggest_anchors(
      *fitted.models.source, *fitted.models.target, fitted.anchors, {arguments.count, tolerance}, progress);
  Anchors suggested;
  for (const SuggestedAnchor& suggestion : suggestions) {
    suggested.pairs.push_back(suggestion.pair);
    if (!arguments.run.quiet) print(suggestion);
  }
  // As the anchors so far: in their unit or, where they say none, in those of the models' files.
  if (anchors.unit.empty())
    scale_anchors(suggested, 1 / fitted.plan.source_scale, 1 / fitted.plan.target_scale);
  anchors.pairs.insert(anchors.pairs.end(), suggested.pairs.begin(), suggested.pairs.end());
  write_anchors(arguments.outputs, anchors, options);
  if (arguments.run.quiet) return;
  if (suggestions.size() < arguments.count)
    std::printf("everywhere else the fits are at most %.4g apart\n", tolerance);
  std::printf("written: %s\n", written(anchors, written_format(arguments.outputs)).c_str());
}

void add_suggest(CLI::App& app) {
  auto arguments = std::make_shared<SuggestArguments>();
  CLI::App* command =
      app.add_subcommand("suggest", "Propose anchors where the fit is worst or least certain, to be checked");
  begin_group(*command, input_group);
  command->add_option("SOURCE", arguments->models.source, "Source model")->required();
  command->add_option("TARGET", arguments->models.target, "Target model")->required();
  add_pose_option(*command, arguments->models.pose, "skinned glTF models");
  command->add_option("--anchors", arguments->anchors, "Anchors so far, in any format of `anchors convert`")
      ->type_name("FILE")
      ->expected(1, 2);
  begin_group(*command, output_group);
  command->add_option("-o,--output", arguments->outputs, "Anchors so far and those proposed, in any format")
      ->type_name("FILE")
      ->required()
      ->expected(1, 2);
  begin_group(*command, quality_group);
  command->add_option("--count", arguments->count, "Propose at most so many")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  add_length_option(*command, "--tolerance", arguments->tolerance,
                    "Nothing is proposed where the fits are closer to each other than this, mesh units or % "
                    "of the target's "
                    "bounding-box diagonal (default: " +
                        percentage(surest) + ")");
  add_run_options(*command, arguments->run);
  command->footer(
      "The source is fitted to the target and the target to the source: where the two fits differ, an anchor "
      "helps. Move the proposed points to where they belong (`bespoke pick SOURCE TARGET --anchors FILE`), "
      "and "
      "give them a smaller sigma.\n\n"
      "Example:\n"
      "  bespoke anchors suggest woman.obj man.obj --anchors anchors.json --count 5 -o more.json");
  command->callback([arguments] {
    run_with(arguments->run, [&](const Progress& progress) { suggest(*arguments, progress); });
  });
}

}  // namespace

void add_anchors_command(CLI::App& app) {
  CLI::App* anchors =
      app.add_subcommand("anchors", "Convert, check and propose anchors: pairs of corresponding points");
  anchors->require_subcommand(1);
  add_convert(*anchors);
  add_audit(*anchors);
  add_suggest(*anchors);
}

}  // namespace bespoke::command
