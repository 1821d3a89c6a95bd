#include <algorithm>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "batch_plan.h"
#include "batch_run.h"
#include "bespoke/anchors/anchors.h"
#include "bespoke/error.h"
#include "bespoke/grading/grade_table.h"
#include "bespoke/product/mesh_io.h"
#include "commands.h"
#include "grade_sizes.h"
#include "html_pages.h"
#include "output_files.h"

namespace bespoke::command {
namespace {

namespace fs = std::filesystem;

struct GradeArguments {
  GradeRequest request;
  std::string sizes;
  std::string target;
  std::string anchors;
  std::string measures;
  std::string log;
  std::string html;
  std::optional<int> between;
  RunOptions run;

  /// What messages say before the number of a line.
  std::string name() const { return sizes.empty() ? "grade" : sizes; }
};

/// All that the tables are made of besides the maps.
struct MeasuringSheet {
  GradedSeries series;                          ///< without sizes yet
  std::vector<std::vector<MeasureLine>> lines;  ///< of each size
};

/// The named ones, on the source (a) or on the target (b).
AnchorPlaces places_of(const Anchors& anchors, Vector3 AnchorPair::*side) {
  AnchorPlaces places;
  for (const AnchorPair& pair : anchors.pairs)
    if (!pair.name.empty()) places[pair.name] = pair.*side;
  return places;
}

Anchors anchors_of(const GradeSize& size) {
  return size.anchors.empty() ? Anchors{} : read_anchors(size.anchors);
}

void require_same_unit(const std::string& a, const std::string& b, const std::string& b_name) {
  if (!a.empty() && !b.empty() && a != b)
    throw InvalidInput("the measures are in " + a + ", but " + b_name + " is in " + b);
}

/// Draws the measures on the source, so that what is wrong with them is known before anything runs.
MeasuringSheet plan_measures(const GradeArguments& arguments, GradeSizes& sizes) {
  const Measures sheet = read_measures(arguments.measures);
  const TriangleMesh source = read_triangle_mesh(arguments.request.source);
  require_valid(source, "source " + arguments.request.source);
  MeasuringSheet planned{{sheet.unit, length_decimals(diagonal(source.vertices)), {}}, {}};
  for (const GradeSize& size : sizes.sizes) {
    try {
      const Anchors anchors = anchors_of(size);
      require_same_unit(sheet.unit, anchors.unit, size.anchors);
      planned.lines.push_back(measure_lines(sheet.measures, source, places_of(anchors, &AnchorPair::a)));
    } catch (const Error& error) {
      sizes.faults.push_back({size.line, error.what()});
    }
  }
  return planned;
}

std::vector<GradedMeasure> measure_size(const GradeSize& size, const std::vector<MeasureLine>& lines,
                                        OpenedMaps& maps) {
  const std::shared_ptr<const OpenedMap> map = maps.open(size.map, MapForm::grids, {});
  std::optional<SizeModel> model;
  if (size.t == 1) model = {read_triangle_mesh(size.target), places_of(anchors_of(size), &AnchorPair::b)};
  return graded_measures(lines, *map, size.t, model ? &*model : nullptr);
}

void write_tables(const GradeRequest& request, const std::vector<GradeSize>& sizes, MeasuringSheet sheet,
                  OpenedMaps& maps, const Progress& progress) {
  GradedSeries& series = sheet.series;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    progress.step("measure", i, sizes.size());
    series.sizes.push_back({sizes[i].name, measure_size(sizes[i], sheet.lines[i], maps)});
    if (i + 1 == sizes.size() || sizes[i + 1].map != sizes[i].map) maps.close(sizes[i].map);
  }
  OutputFiles files;
  for (const GradedSize& size : series.sizes) {
    const fs::path directory = request.out_dir / size.name;
    fs::create_directories(directory);
    files.write_text(directory / "measures.csv", size_csv(size));
    files.write_text(directory / "measures.md", size_markdown(series, size));
  }
  files.write_text(request.out_dir / "measures.csv", series_csv(series));
  files.write_text(request.out_dir / "measures.md", series_markdown(series));
  files.keep();
}

/// All tables, as one job that waits for the maps.
BatchJob tables_job(const GradeArguments& arguments, const std::vector<GradeSize>& sizes,
                    const MeasuringSheet& sheet, OpenedMaps& maps) {
  const GradeRequest& request = arguments.request;
  BatchJob job;
  job.command = "measures";
  job.inputs = {{"source", request.source}, {"measures", arguments.measures}};
  job.outputs = {{"output", request.out_dir / "measures.csv"}, {"output", request.out_dir / "measures.md"}};
  std::string names;
  for (const GradeSize& size : sizes) {
    names += size.name + " at " + std::to_string(size.t) + "\n";
    for (JobFile& file : named_files({{"map", size.map}, {"target", size.target}, {"anchors", size.anchors}}))
      job.inputs.push_back(std::move(file));
    for (const char* name : {"measures.csv", "measures.md"})
      job.outputs.push_back({"output", request.out_dir / size.name / name});
  }
  job.options = {{"sizes", names}};
  job.run = [request, sizes, sheet, &maps](const Progress& progress) {
    write_tables(request, sizes, sheet, maps, progress);
    return JobFindings{};
  };
  return job;
}

std::vector<ShownMap> shown_sizes(const GradeRequest& request, const std::vector<GradeSize>& sizes) {
  std::vector<ShownMap> shown;
  for (const GradeSize& size : sizes)
    shown.push_back(
        {size.line, size.name, size.map, request.source, size.target, request.products, {}, {}, size.t});
  return shown;
}

JobGraph graph_of(const GradeArguments& arguments, GradeSizes sizes, OpenedMaps& maps,
                  const HtmlPages* pages) {
  std::optional<MeasuringSheet> sheet;
  if (!arguments.measures.empty()) sheet = plan_measures(arguments, sizes);
  Manifest manifest = grade_manifest(arguments.request, sizes);
  std::vector<BatchJob> jobs = plan_jobs(manifest, maps, pages);
  if (sheet && manifest.faults.empty()) jobs.push_back(tables_job(arguments, sizes.sizes, *sheet, maps));
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
  const fs::path& out_dir = arguments.request.out_dir;
  if (fs::exists(out_dir) && !fs::is_directory(out_dir))
    throw FileError(out_dir.string() + ": is no directory");
  OpenedMaps maps;
  const GradeSizes sizes = arguments.sizes.empty() ? sizes_between(arguments.target, arguments.anchors,
                                                                   arguments.between.value_or(0), out_dir)
                                                   : sizes_of_table(arguments.sizes, out_dir);
  std::optional<HtmlPages> pages;
  if (!arguments.html.empty()) pages.emplace(arguments.html, shown_sizes(arguments.request, sizes.sizes));
  const JobGraph graph = graph_of(arguments, sizes, maps, pages ? &*pages : nullptr);
  require_no_faults(arguments.name(), graph.faults);
  run_jobs({arguments.name(), arguments.run.quiet ? BatchStyle::quiet : BatchStyle::line, arguments.log},
           graph, forecast_jobs(graph), batch_options(arguments.run.threads), maps,
           pages ? &*pages : nullptr);
  if (arguments.run.quiet || arguments.measures.empty()) return;
  std::ifstream table(out_dir / "measures.md");
  std::cout << table.rdbuf();
}

void add_sizes(CLI::App& grade, GradeArguments& arguments) {
  grade
      .add_option(
          "--sizes", arguments.sizes,
          "Table of sizes with a header: size,target, and where wanted anchors, t (how far the map to "
          "the target goes, 1) and options of `fit` by their names")
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
  grade->add_option("SOURCE", request.source, "Reference model that products are designed around")
      ->required();
  grade->add_option("PRODUCT", request.products,
                    "What to carry; the source itself gives a model of each size");
  add_sizes(*grade, *arguments);
  grade->add_option("--measures", arguments->measures, "Girths and lengths, by planes or anchors")
      ->type_name("MEASURES.json");
  grade
      ->add_option("--out-dir", request.out_dir,
                   "Gets measures.csv and .md, and a folder a size: products, map.vdb, measures.csv and .md")
      ->required()
      ->type_name("DIR");
  for (const auto& [name, parts] : {std::pair{"--rigid", &request.rigid}, {"--similar", &request.similar}})
    grade->add_option(name, *parts, "Parts that keep their shape, as for `apply`; repeatable")
        ->type_name("NAME")
        ->allow_extra_args(false);
  grade->add_option("--log", arguments->log, "Append one JSON line a job")->type_name("FILE.jsonl");
  grade
      ->add_option("--html", arguments->html,
                   "Write a page for every map, and an index of the sizes with pictures")
      ->type_name("DIR");
  add_run_options(*grade, arguments->run);
  grade->footer(
      "What is up to date is not repeated (see `bespoke batch --help`). A girth is the section of the "
      "source\n"
      "that goes round the plane's point; a loop or path goes over the surface through anchors or points.\n\n"
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
