#include <fstream>
#include <memory>
#include <optional>
#include <utility>

#include "batch_plan.h"
#include "batch_run.h"
#include "bespoke/error.h"
#include "clearance_option.h"
#include "commands.h"
#include "grade_patterns.h"
#include "grade_sizes.h"
#include "grade_tables.h"
#include "help.h"
#include "html_pages.h"

namespace bespoke::command {
namespace {

namespace fs = std::filesystem;

struct GradeArguments {
  GradeRequest request;
  PatternRequest patterns;
  std::string sizes;
  std::string target;
  std::string anchors;
  std::string measures;
  std::string log;
  std::string html;
  std::optional<int> between;
  bool keep_going = false;
  RunOptions run;

  /// What messages say before the number of a line.
  std::string name() const { return sizes.empty() ? "grade" : sizes; }
};

std::vector<ShownMap> shown_sizes(const GradeRequest& request, const std::vector<GradeSize>& sizes) {
  std::vector<ShownMap> shown;
  for (const GradeSize& size : sizes) {
    ProductsAsWorn worn{request.products, {}, std::nullopt, {request.clearance}};
    if (const auto pose = pose_of(size)) worn.pose = value_of(model_poses, *pose);
    shown.push_back({size.line, size.name, size.map, request.source, size.target, worn, {}, {}, size.t});
  }
  return shown;
}

JobGraph graph_of(const GradeArguments& arguments, GradeSizes sizes, OpenedMaps& maps,
                  const HtmlPages* pages) {
  std::optional<MeasuringSheet> sheet;
  if (!arguments.measures.empty()) sheet = plan_measures(arguments.request, arguments.measures, sizes);
  Manifest manifest = grade_manifest(arguments.request, sizes);
  std::vector<BatchJob> jobs = plan_jobs(manifest, maps, pages);
  if (sheet && manifest.faults.empty())
    for (BatchJob& job : table_jobs(arguments.request, sizes.sizes, *sheet, maps))
      jobs.push_back(std::move(job));
  if (manifest.faults.empty())
    for (BatchJob& job : pattern_jobs(arguments.request, sizes.sizes, arguments.patterns))
      jobs.push_back(std::move(job));
  JobGraph graph = make_job_graph(std::move(jobs));
  graph.faults.insert(graph.faults.end(), manifest.faults.begin(), manifest.faults.end());
  return graph;
}

void require_one_kind_of_sizes(const GradeArguments& arguments) {
  if (arguments.sizes.empty() == arguments.target.empty())
    throw CLI::ValidationError("grade", "give either --sizes TABLE.csv or --target MESH");
  if (!arguments.sizes.empty() && (arguments.between || !arguments.anchors.empty()))
    throw CLI::ValidationError("--sizes",
                               "names targets and anchors itself; leave out --between and --anchors");
  if (arguments.request.products.empty() && arguments.measures.empty())
    throw CLI::ValidationError("grade", "give products, --measures, or both");
}

void run(const GradeArguments& arguments) {
  require_one_kind_of_sizes(arguments);
  require_valid(ClearanceOption{arguments.request.clearance, arguments.request.require_clear, false});
  const fs::path& out_dir = arguments.request.out_dir;
  if (fs::exists(out_dir) && !fs::is_directory(out_dir))
    throw FileError(out_dir.string() + ": is no directory but a file; name another");
  OpenedMaps maps;
  const GradeSizes sizes = arguments.sizes.empty() ? sizes_between(arguments.target, arguments.anchors,
                                                                   arguments.between.value_or(0), out_dir)
                                                   : sizes_of_table(arguments.sizes, out_dir);
  std::optional<HtmlPages> pages;
  if (!arguments.html.empty()) pages.emplace(arguments.html, shown_sizes(arguments.request, sizes.sizes));
  const JobGraph graph = graph_of(arguments, sizes, maps, pages ? &*pages : nullptr);
  require_no_faults(arguments.name(), graph.faults);
  BatchOptions options = batch_options(arguments.run.threads);
  options.keep_going = arguments.keep_going;
  run_jobs({arguments.name(), arguments.run.quiet ? BatchStyle::quiet : BatchStyle::line, arguments.log,
            pages ? &*pages : nullptr},
           graph, forecast_jobs(graph), options, maps);
  if (arguments.run.quiet || arguments.measures.empty()) return;
  std::ifstream table(out_dir / "measures.md");
  std::cout << table.rdbuf();
}

void add_sizes(CLI::App& grade, GradeArguments& arguments) {
  grade
      .add_option(
          "--sizes", arguments.sizes,
          "Table of sizes with a header: size, target and, as needed, anchors, t (how far the map to the "
          "target goes, default 1) and options of `fit` by their names")
      ->type_name("TABLE.csv");
  grade.add_option("--target", arguments.target, "Instead of a table: the model of the last size")
      ->type_name("MESH");
  grade.add_option("--anchors", arguments.anchors, "With --target: pairs of points on source and target")
      ->type_name("FILE");
  grade
      .add_option("--between", arguments.between,
                  "With --target: sizes between source and target, in equal steps of one map (default: 0)")
      ->check(CLI::Range(0, 1000))
      ->type_name("N");
}

}  // namespace

void add_grade_command(CLI::App& app) {
  auto arguments = std::make_shared<GradeArguments>();
  GradeRequest& request = arguments->request;
  CLI::App* grade = app.add_subcommand("grade", "Carry products to many sizes, and measure each");
  begin_group(*grade, input_group);
  grade->add_option("SOURCE", request.source, "Reference model that products are designed around")
      ->required();
  grade->add_option("PRODUCT", request.products,
                    "What to carry; the source itself gives a model of each size");
  add_sizes(*grade, *arguments);
  grade->add_option("--measures", arguments->measures, "Girths and lengths, by planes or anchors")
      ->type_name("MEASURES.json");
  begin_group(*grade, output_group);
  grade
      ->add_option(
          "--out-dir", request.out_dir,
          "Directory for measures.csv and .md, and a folder a size: products, map.vdb, measures.csv and .md")
      ->required()
      ->type_name("DIR");
  grade->add_option("--log", arguments->log, "Append one JSON line a job")->type_name("FILE.jsonl");
  grade
      ->add_option("--html", arguments->html,
                   "Write a page for every map, and an index of the sizes with pictures")
      ->type_name("DIR");
  add_pattern_options(*grade, arguments->patterns);
  begin_group(*grade, method_group);
  for (const auto& [name, parts] : {std::pair{"--rigid", &request.rigid}, {"--similar", &request.similar}})
    grade->add_option(name, *parts, "Parts that keep their shape, as for `apply`; repeatable")
        ->type_name("NAME")
        ->allow_extra_args(false);
  grade
      ->add_option(
          "--clearance", request.clearance,
          "What products keep from the models of the sizes, as for `apply`: keep, same, a length, or off; "
          "sizes on the way (t other than 1) are carried without (default: off)")
      ->type_name("keep|same|LENGTH|off");
  grade->add_flag("--require-clear", request.require_clear, require_clear_help);
  begin_group(*grade, jobs_group);
  grade->add_flag("--keep-going", arguments->keep_going,
                  "After a size has failed, go on with the others; the tables of the series need all sizes");
  add_run_options(*grade, arguments->run);
  grade->footer(
      "What is up to date is not repeated (see `bespoke batch --help`). A girth is the section of the source "
      "that goes round the plane's point; a loop or path runs over the surface through anchors or points.\n\n"
      "Examples:\n"
      "  bespoke grade body.obj top.obj --sizes sizes.csv --measures measures.json --out-dir sizes\n"
      "  bespoke grade body.obj top.obj --target large.obj --anchors pairs.json --between 3 --out-dir "
      "sizes\n\n"
      "  {\"units\":\"cm\",\"measures\":[\n"
      "    {\"name\":\"hips\",\"plane\":{\"point\":[0,84,0],\"normal\":[0,1,0]}},\n"
      "    {\"name\":\"shoulders\",\"path\":[\"left_shoulder\",\"neck_back\",\"right_shoulder\"]}]}");
  grade->callback([arguments] { run(*arguments); });
}

}  // namespace bespoke::command
