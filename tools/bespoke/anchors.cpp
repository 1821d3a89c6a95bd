#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/anchors/anchor_accuracy.h"
#include "bespoke/anchors/anchor_audit.h"
#include "bespoke/anchors/anchor_files.h"
#include "bespoke/anchors/anchor_placement.h"
#include "bespoke/anchors/contradicting_anchors.h"
#include "bespoke/error.h"
#include "bespoke/product/mesh_io.h"
#include "commands.h"
#include "output_files.h"

namespace bespoke::command {
namespace {

/// The models that an anchors file belongs to, where they are given.
struct ModelArguments {
  std::string source;
  std::string target;
};

struct Models {
  std::optional<TriangleMesh> source;
  std::optional<TriangleMesh> target;
};

void add_model_options(CLI::App& app, ModelArguments& arguments, const std::string& why) {
  app.add_option("--source", arguments.source, "Source model: " + why)->type_name("MESH");
  app.add_option("--target", arguments.target, "Target model: " + why)->type_name("MESH");
}

Models read_models(const ModelArguments& arguments) {
  Models models;
  if (!arguments.source.empty()) models.source = read_triangle_mesh(arguments.source);
  if (!arguments.target.empty()) models.target = read_triangle_mesh(arguments.target);
  return models;
}

AnchorFileOptions file_options(const Models& models, PatientSystem system = PatientSystem::lps) {
  return {models.source ? &*models.source : nullptr, models.target ? &*models.target : nullptr, system};
}

std::vector<std::filesystem::path> as_paths(const std::vector<std::string>& names) {
  return {names.begin(), names.end()};
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
  write_anchor_files(as_paths(arguments.outputs), anchors, options);
  std::cout << anchors.pairs.size() << " pairs\n";
}

void add_convert(CLI::App& app) {
  auto arguments = std::make_shared<ConvertArguments>();
  CLI::App* command =
      app.add_subcommand("convert", "Turn pairs of points into the format of another program");
  command
      ->add_option("INPUT", arguments->inputs,
                   "Pairs; where a format has one file a side, the source's and the target's")
      ->required()
      ->expected(1, 2);
  command->add_option("-o,--output", arguments->outputs, "File or files to write; endings say the formats")
      ->required()
      ->expected(1, 2);
  add_model_options(*command, arguments->models, "needed for .wrap.json and .txt, which name places of it");
  command
      ->add_option("--coordinates", arguments->coordinates,
                   "Patient coordinates of the models, for 3D Slicer's files")
      ->check(CLI::IsMember({"LPS", "RAS"}))
      ->capture_default_str();
  command->footer(
      "Endings: .json and .csv (both sides in one file), .pp (MeshLab), .mrk.json and .fcsv (3D Slicer), "
      ".pts\n"
      "(Landmark Editor), .wrap.json ([triangle, u, v] lists), .txt (two vertex numbers a line, from 0).\n\n"
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
  const AnchorPlacement placement = anchor_placement(*model, points);
  return placement.is_far() && print(std::string(side) + ": " + to_string(placement) + "; another unit?");
}

void audit(const AuditArguments& arguments) {
  const Models models = read_models(arguments.models);
  const Anchors anchors = read_anchor_files(as_paths(arguments.inputs), file_options(models));
  const AnchorAudit found = audit_anchors(anchors);
  std::cout << anchors.pairs.size() << " pairs, each within " << found.typical_distance
            << " (median) of where the others put it\n";
  bool is_doubted = print(to_string(found, anchors));
  is_doubted |= print(to_string(swapped_anchors(anchors), anchors));
  is_doubted |= print(to_string(contradicting_anchors(anchors), anchors));
  is_doubted |= print_far("source", models.source, source_points(anchors));
  is_doubted |= print_far("target", models.target, target_points(anchors));
  if (models.source && models.target)
    is_doubted |= print(to_string(rate_anchors(anchors, *models.source, *models.target).accuracy, anchors));
  if (!is_doubted) std::cout << "nothing is suspicious\n";
}

void add_audit(CLI::App& app) {
  auto arguments = std::make_shared<AuditArguments>();
  CLI::App* command =
      app.add_subcommand("audit", "Say what is suspicious about pairs, as fit does, without fitting");
  command->add_option("INPUT", arguments->inputs, "Pairs, in any format of `anchors convert`")
      ->required()
      ->expected(1, 2);
  add_model_options(*command, arguments->models, "more is checked with both");
  command->footer(
      "Examples:\n"
      "  bespoke anchors audit anchors.json\n"
      "  bespoke anchors audit anchors.json --source woman.obj --target man.obj");
  command->callback([arguments] { audit(*arguments); });
}

}  // namespace

void add_anchors_command(CLI::App& app) {
  CLI::App* anchors = app.add_subcommand("anchors", "Convert and check pairs of points");
  anchors->require_subcommand(1);
  add_convert(*anchors);
  add_audit(*anchors);
}

}  // namespace bespoke::command
