#include "grade_tables.h"

#include <charconv>
#include <memory>
#include <optional>
#include <system_error>
#include <utility>

#include "batch_display.h"
#include "bespoke/anchors/anchor_files.h"
#include "bespoke/anchors/anchor_scale.h"
#include "bespoke/atomic_file.h"
#include "bespoke/cloud/target_model.h"
#include "bespoke/error.h"
#include "bespoke/grading/grade_table.h"
#include "bespoke/number_format.h"
#include "bespoke/product/format_unit.h"
#include "output_files.h"
#include "planned_run.h"

namespace bespoke::command {
namespace {

namespace fs = std::filesystem;

/// The named ones, on the source (a) or on the target (b).
AnchorPlaces places_of(const Anchors& anchors, Vector3 AnchorPair::*side) {
  AnchorPlaces places;
  for (const AnchorPair& pair : anchors.pairs)
    if (!pair.name.empty()) places[pair.name] = pair.*side;
  return places;
}

Anchors anchors_of(const GradeSize& size) {
  return size.anchors.empty() ? Anchors{} : read_anchor_file(size.anchors);
}

void require_same_unit(const std::string& a, const std::string& b, const std::string& b_name) {
  if (!a.empty() && !b.empty() && a != b)
    throw InvalidInput("the measures are in " + a + ", but " + b_name + " is in " + b);
}

GradedSeries without_sizes(const MeasuringSheet& sheet) { return {sheet.unit, sheet.decimals, {}}; }

double number_of(const std::string& text, const std::string& place) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size())
    throw InvalidInput(place + ": \"" + text + "\" is no length; remove the table to have it made again");
  return value;
}

/// What size_csv has written.
std::vector<GradedMeasure> read_measures_of_size(const fs::path& table) {
  std::vector<GradedMeasure> measures;
  for (const ManifestJob& row : read_table(table, "measure").jobs) {
    GradedMeasure& measure = measures.emplace_back();
    measure.name = row.command;
    for (const ManifestEntry& cell : row.entries) {
      const double length = number_of(cell.values.front(), place_in(table.string(), row.line));
      if (cell.key == "source")
        measure.source = length;
      else if (cell.key == "carried")
        measure.carried = length;
      else
        measure.model = length;
    }
  }
  return measures;
}

void write_tables(const fs::path& directory, const std::string& csv, const std::string& markdown) {
  make_directories(directory);
  OutputFiles files;
  files.write_text(directory / "measures.csv", csv);
  files.write_text(directory / "measures.md", markdown);
  files.keep();
}

/// In the map's unit and pose, as the fit has taken it: anchors that say no unit go with their model.
SizeModel model_of(const GradeSize& size, const OpenedMap& map) {
  TriangleMesh mesh = read_target(size.target, map.unit, map.target_hash).mesh;
  Anchors anchors = anchors_of(size);
  const double of_anchors = anchors.unit.empty() ? scale_to_unit(size.target, map.unit)
                                                 : unit_factor(anchors.unit, map.unit).value_or(1);
  scale_anchors(anchors, of_anchors, of_anchors);
  return {std::move(mesh), places_of(anchors, &AnchorPair::b)};
}

BatchJob job_for(const fs::path& directory) {
  BatchJob job;
  job.command = "measures";
  job.outputs = {{"output", directory / "measures.csv"}, {"output", directory / "measures.md"}};
  return job;
}

BatchJob size_job(const GradeRequest& request, const GradeSize& size, const MeasuringSheet& sheet,
                  const std::vector<MeasureLine>& lines, OpenedMaps& maps) {
  const fs::path directory = folder(request, size);
  BatchJob job = job_for(directory);
  job.line = size.line;
  job.options = {{"size", size.name}, {"t", format_number(size.t, 17)}};
  job.inputs = named_files({{"map", size.map.string()},
                            {"source", request.source},
                            {"measures", sheet.measures.string()},
                            {"target", size.target},
                            {"anchors", size.anchors}});
  job.shared_map = size.map;
  job.run = [size, series = without_sizes(sheet), lines, directory, &maps](const Progress&) {
    const std::shared_ptr<const OpenedMap> map = maps.open(size.map, MapForm::grids, {});
    std::optional<SizeModel> model;
    if (size.t == 1) model = model_of(size, *map);
    const GradedSize graded{size.name, graded_measures(lines, *map, size.t, model ? &*model : nullptr)};
    write_tables(directory, size_csv(graded), size_markdown(series, graded));
    return JobFindings{};
  };
  return job;
}

BatchJob series_job(const GradeRequest& request, const std::vector<GradeSize>& sizes,
                    const MeasuringSheet& sheet) {
  BatchJob job = job_for(request.out_dir);
  std::vector<std::pair<std::string, fs::path>> tables;
  std::string names;
  for (const GradeSize& size : sizes) {
    tables.emplace_back(size.name, folder(request, size) / "measures.csv");
    job.inputs.push_back({"table", tables.back().second});
    names += size.name + "\n";
  }
  job.options = {{"sizes", names}};
  job.run = [tables, series = without_sizes(sheet), directory = request.out_dir](const Progress&) {
    GradedSeries whole = series;
    for (const auto& [name, table] : tables) whole.sizes.push_back({name, read_measures_of_size(table)});
    write_tables(directory, series_csv(whole), series_markdown(whole));
    return JobFindings{};
  };
  return job;
}

}  // namespace

MeasuringSheet plan_measures(const GradeRequest& request, const fs::path& measures, GradeSizes& sizes) {
  const Measures sheet = read_measures(measures);
  const TriangleMesh source = read_source(request.source);
  // Lines of sizes whose fits take the other pose of a skinned source.
  std::optional<TriangleMesh> stored;
  require_valid(source, "source " + request.source);
  MeasuringSheet planned{measures, sheet.unit, length_decimals(diagonal(source.vertices)), {}};
  for (const GradeSize& size : sizes.sizes) {
    try {
      const Anchors anchors = anchors_of(size);
      require_same_unit(sheet.unit, anchors.unit, size.anchors);
      const bool is_stored = pose_of(size) == name_of(model_poses, ModelPose::stored);
      if (is_stored && !stored) stored = read_source_model(request.source, ModelPose::stored).mesh;
      planned.lines.push_back(
          measure_lines(sheet.measures, is_stored ? *stored : source, places_of(anchors, &AnchorPair::a)));
    } catch (const Error& error) {
      sizes.faults.push_back({size.line, error.what()});
    }
  }
  return planned;
}

std::vector<BatchJob> table_jobs(const GradeRequest& request, const std::vector<GradeSize>& sizes,
                                 const MeasuringSheet& sheet, OpenedMaps& maps) {
  std::vector<BatchJob> jobs;
  for (std::size_t i = 0; i < sizes.size(); ++i)
    jobs.push_back(size_job(request, sizes[i], sheet, sheet.lines[i], maps));
  jobs.push_back(series_job(request, sizes, sheet));
  return jobs;
}

}  // namespace bespoke::command
