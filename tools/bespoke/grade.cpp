#include <fstream>
#include <memory>
#include <optional>

#include "batch_plan.h"
#include "batch_run.h"
#include "bespoke/anchors/anchors.h"
#include "bespoke/batch/manifest.h"
#include "bespoke/error.h"
#include "bespoke/grading/grade_table.h"
#include "bespoke/mesh/mesh_io.h"
#include "commands.h"
#include "output_files.h"

namespace bespoke::command {
namespace {

namespace fs = std::filesystem;

struct GradeArguments {
  std::string source;
  std::vector<std::string> products;
  std::string sizes;
  std::string target;
  std::string anchors;
  std::string measures;
  std::string out_dir;
  std::string log;
  std::optional<int> between;
  RunOptions run;
};

/// One size: what it is called, and how the source gets there.
struct Size {
  std::string name;
  std::string target;
  std::string anchors;  ///< empty: none
  std::string map;
  double t = 1;
};

/// The value of a key in a line of the table; empty where there is none.
std::string cell(const ManifestJob& line, const std::string& key) {
  for (const ManifestEntry& entry : line.entries)
    if (entry.key == key) return entry.values.front();
  return {};
}

/// Rows size,target,anchors. The table is read as a manifest whose command is the size.
std::vector<Size> sizes_of_table(const GradeArguments& arguments) {
  const Manifest table = read_table(arguments.sizes, "size");
  if (!table.faults.empty()) require_no_faults(arguments.sizes, table.faults);
  std::vector<Size> sizes;
  for (const ManifestJob& line : table.jobs) {
    const Size size{line.command, cell(line, "target"), cell(line, "anchors"),
                    (fs::path(arguments.out_dir) / line.command / "map.vdb").string()};
    const bool is_name = !size.name.empty() && fs::path(size.name).filename() == size.name;
    if (!is_name || size.name == ".." || size.name == "." || size.target.empty())
      throw InvalidInput(arguments.sizes + ":" + std::to_string(line.line) +
                         ": needs a size that can name a folder, and a target");
    sizes.push_back(size);
  }
  if (sizes.empty()) throw InvalidInput(arguments.sizes + ": holds no size");
  return sizes;
}

/// The target and what lies between, by the time of one map.
std::vector<Size> sizes_between(const GradeArguments& arguments) {
  const int count = arguments.between.value_or(0) + 1;
  const std::string map = (fs::path(arguments.out_dir) / "map.vdb").string();
  std::vector<Size> sizes;
  for (int k = 1; k <= count; ++k)
    sizes.push_back({std::to_string(k) + "_of_" + std::to_string(count), k == count ? arguments.target : "",
                     arguments.anchors, map, static_cast<double>(k) / count});
  return sizes;
}

ManifestJob fit_job(const GradeArguments& arguments, const Size& size, const std::string& target) {
  ManifestJob job{1, "fit", {{"source", {arguments.source}}, {"target", {target}}, {"output", {size.map}}}};
  if (!size.anchors.empty()) job.entries.push_back({"anchors", {size.anchors}});
  return job;
}

ManifestJob apply_job(const GradeArguments& arguments, const Size& size) {
  char t[32];
  std::snprintf(t, sizeof t, "%.17g", size.t);
  return {1,
          "apply",
          {{"map", {size.map}},
           {"product", arguments.products},
           {"t", {t}},
           {"out-dir", {(fs::path(arguments.out_dir) / size.name).string()}}}};
}

std::map<std::string, Vector3> named_anchors(const std::string& path) {
  std::map<std::string, Vector3> named;
  if (!path.empty())
    for (const AnchorPair& pair : read_anchors(path).pairs) named[pair.name] = pair.a;
  return named;
}

void write_tables(const GradeArguments& arguments, const Size& size, const OpenedMap& map) {
  const TriangleMesh source = read_triangle_mesh(arguments.source);
  require_valid(source, arguments.source);
  const Measures sheet = read_measures(arguments.measures);
  const std::vector<MeasureLine> lines = measure_lines(sheet.measures, source, named_anchors(size.anchors));
  std::optional<TriangleMesh> target;
  if (!size.target.empty()) target = read_triangle_mesh(size.target);
  const std::vector<GradedMeasure> graded = grade(lines, map, size.t, target ? &*target : nullptr);
  const fs::path directory = fs::path(arguments.out_dir) / size.name;
  OutputFiles files;
  files.write_text(directory / "measures.csv", grade_csv(graded));
  files.write_text(directory / "measures.md", grade_markdown(size.name, sheet.unit, graded));
  files.keep();
}

/// The table of a size, as a job beside those of the subcommands.
BatchJob table_job(const GradeArguments& arguments, const Size& size, OpenedMaps& maps) {
  const fs::path directory = fs::path(arguments.out_dir) / size.name;
  BatchJob job;
  job.line = 1;
  job.command = "measures";
  job.options = {{"size", size.name}, {"t", std::to_string(size.t)}};
  job.inputs = named_files({{"map", size.map},
                            {"source", arguments.source},
                            {"target", size.target},
                            {"anchors", size.anchors},
                            {"measures", arguments.measures}});
  job.outputs = {{"output", directory / "measures.csv"}, {"output", directory / "measures.md"}};
  job.shared_map = size.map;
  job.run = [arguments, size, &maps](const Progress&) {
    write_tables(arguments, size, *maps.open(size.map, MapForm::grids, {}));
    return JobFindings{};
  };
  return job;
}

std::vector<BatchJob> jobs_of(const GradeArguments& arguments, const std::vector<Size>& sizes,
                              OpenedMaps& maps) {
  JobPlanner planner(maps);
  std::vector<BatchJob> jobs;
  std::string fitted;
  for (const Size& size : sizes) {
    if (size.map != fitted)
      jobs.push_back(
          planner.plan(fit_job(arguments, size, arguments.sizes.empty() ? arguments.target : size.target)));
    fitted = size.map;
    if (!arguments.products.empty()) jobs.push_back(planner.plan(apply_job(arguments, size)));
    if (!arguments.measures.empty()) jobs.push_back(table_job(arguments, size, maps));
  }
  return jobs;
}

void run(const GradeArguments& arguments) {
  if (arguments.sizes.empty() == arguments.target.empty())
    throw CLI::ValidationError("grade", "give either --sizes TABLE or --target MESH");
  if (!arguments.sizes.empty() && (arguments.between || !arguments.anchors.empty()))
    throw CLI::ValidationError("--sizes",
                               "names targets and anchors itself; leave out --between and --anchors");
  if (arguments.products.empty() && arguments.measures.empty())
    throw CLI::ValidationError("grade", "give products, --measures, or both");
  OpenedMaps maps;
  const std::vector<Size> sizes =
      arguments.sizes.empty() ? sizes_between(arguments) : sizes_of_table(arguments);
  const JobGraph graph = make_job_graph(jobs_of(arguments, sizes, maps));
  require_no_faults("grade", graph.faults);
  run_jobs({"grade", arguments.run.quiet ? BatchStyle::quiet : BatchStyle::line, arguments.log}, graph,
           forecast_jobs(graph), batch_options(arguments.run.threads), maps);
  if (arguments.run.quiet || arguments.measures.empty()) return;
  for (const Size& size : sizes) {
    std::ifstream table(fs::path(arguments.out_dir) / size.name / "measures.md");
    std::cout << table.rdbuf() << '\n';
  }
}

}  // namespace

void add_grade_command(CLI::App& app) {
  auto arguments = std::make_shared<GradeArguments>();
  CLI::App* grade = app.add_subcommand("grade", "Carry products to many sizes, and measure each");
  grade->add_option("SOURCE", arguments->source, "Reference model that products are designed around")
      ->required();
  grade->add_option("PRODUCT", arguments->products, "Meshes or point sets around the source");
  grade->add_option("--sizes", arguments->sizes, "Table of the sizes, with a header: size,target[,anchors]")
      ->type_name("TABLE.csv");
  grade->add_option("--target", arguments->target, "The largest size, instead of a table")->type_name("MESH");
  grade->add_option("--anchors", arguments->anchors, "Pairs of corresponding points on source and target")
      ->type_name("FILE");
  grade->add_option("--between", arguments->between, "Sizes between source and target (default: 0)")
      ->check(CLI::Range(0, 1000))
      ->type_name("N");
  grade->add_option("--measures", arguments->measures, "Girths and lengths, by planes or anchors")
      ->type_name("MEASURES.json");
  grade
      ->add_option("--out-dir", arguments->out_dir,
                   "Gets a folder a size: products, measures.csv, measures.md")
      ->required()
      ->type_name("DIR");
  grade->add_option("--log", arguments->log, "Append one JSON line a job")->type_name("FILE.jsonl");
  add_run_options(*grade, arguments->run);
  grade->footer(
      "Nothing is repeated that is up to date (see `bespoke batch --help`).\n\n"
      "Examples:\n"
      "  bespoke grade body.obj top.obj --sizes sizes.csv --measures measures.json --out-dir sizes\n"
      "  bespoke grade body.obj top.obj --target large.obj --anchors pairs.json --between 3 --out-dir "
      "sizes\n\n"
      "  {\"unit\":\"cm\",\"measures\":[\n"
      "    {\"name\":\"hips\",\"plane\":{\"point\":[0,84,0],\"normal\":[0,1,0]}},\n"
      "    {\"name\":\"shoulders\",\"path\":[\"left_shoulder\",\"neck_back\",\"right_shoulder\"]}]}");
  grade->callback([arguments] { run(*arguments); });
}

}  // namespace bespoke::command
