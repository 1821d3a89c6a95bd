#include "grade_patterns.h"

#include <algorithm>
#include <utility>

#include "bespoke/number_format.h"
#include "bespoke/pattern/size_table.h"
#include "bespoke/pattern/write_pattern.h"
#include "output_files.h"
#include "pattern_options.h"
#include "planned_run.h"

namespace bespoke::command {
namespace {

namespace fs = std::filesystem;

fs::path pattern_file(const GradeRequest& request, const fs::path& product, const char* ending) {
  return request.out_dir / (product.stem().string() + "_pattern" + ending);
}

/// A size's name, and the product carried to it.
using CarriedProduct = std::pair<std::string, fs::path>;

void write_patterns(const GradeRequest& request, const std::string& product, const PatternRequest& patterns,
                    const std::vector<CarriedProduct>& carried) {
  const GarmentOptions reading{PieceRule::automatic, patterns.unit};
  const Garment source = read_garment(product, reading);
  PatternOptions options;
  options.cut.auto_cut = patterns.auto_cut;
  if (!patterns.seams.empty()) options.cut.seams = read_seam_file(patterns.seams, source.mesh);
  std::vector<SizedPattern> sizes{{"source", flat_pattern(source, &source, options)}};
  for (const auto& [name, path] : carried)
    sizes.push_back({name, flat_pattern(read_garment(path, reading), &source, options)});
  SheetOptions drawing;
  drawing.seam_allowance = patterns.seam_allowance;
  const Sheet sheet = nested_sheet(sizes, drawing);
  const PatternFileOptions notes{.name = fs::path(product).stem().string()};
  OutputFiles files;
  for (const char* ending : {".svg", ".dxf"})
    files.write(pattern_file(request, product, ending),
                [&](const fs::path& path) { write_sheet(path, sheet, notes); });
  files.write_text(pattern_file(request, product, ".csv"), size_table_csv(sizes));
  files.keep();
}

}  // namespace

void add_pattern_options(CLI::App& grade, PatternRequest& request) {
  grade
      .add_option(
          "--flatten", request.products,
          "Of these products, write the pieces of all sizes, nested, and their measures: NAME_pattern.svg, "
          ".dxf and .csv")
      ->type_name("PRODUCT")
      ->allow_extra_args(false);
  grade
      .add_option("--flatten-unit", request.unit, "Unit of their coordinates, where the format says none: cm")
      ->type_name("UNIT");
  grade.add_option("--seams", request.seams, "Where they are cut, as for `flatten`")->type_name("SEAMS.json");
  grade.add_flag("--auto-cut", request.auto_cut, "Cut pieces that are no disks along shortest loops");
  add_seam_allowance(grade, request.seam_allowance);
}

std::vector<BatchJob> pattern_jobs(const GradeRequest& request, const std::vector<GradeSize>& sizes,
                                   const PatternRequest& patterns) {
  std::vector<BatchJob> jobs;
  for (const std::string& product : patterns.products) {
    if (std::find(request.products.begin(), request.products.end(), product) == request.products.end())
      throw CLI::ValidationError("--flatten", product + " is none of the products that are carried");
    BatchJob job;
    job.command = "patterns";
    job.inputs = named_files({{"source", product}, {"seams", patterns.seams}});
    std::vector<CarriedProduct> carried;
    std::string names;
    for (const GradeSize& size : sizes) {
      carried.emplace_back(size.name, folder(request, size) / fs::path(product).filename());
      job.inputs.push_back({"product", carried.back().second});
      names += size.name + "\n";
    }
    for (const char* ending : {".svg", ".dxf", ".csv"})
      job.outputs.push_back({"output", pattern_file(request, product, ending)});
    job.options = {{"sizes", names},
                   {"unit", patterns.unit},
                   {"auto-cut", patterns.auto_cut ? "yes" : "no"},
                   {"seam-allowance", format_number(patterns.seam_allowance, 17)}};
    job.run = [=](const Progress&) {
      write_patterns(request, product, patterns, carried);
      return JobFindings{};
    };
    jobs.push_back(std::move(job));
  }
  return jobs;
}

}  // namespace bespoke::command
