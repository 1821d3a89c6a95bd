#include "bespoke/grading/grade_table.h"

#include <cstdio>

#include "bespoke/apply/apply_mapping.h"

namespace bespoke {
namespace {

std::string number(const char* format, double value) {
  char text[40];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

/// A name as a cell of a table whose cells end at commas.
std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

std::vector<GradedMeasure> grade(const std::vector<MeasureLine>& lines, const OpenedMap& map, double t,
                                 const TriangleMesh* target) {
  std::vector<GradedMeasure> graded;
  for (const MeasureLine& line : lines) {
    const AppliedPoints moved =
        apply_mapping(*map.elastic, map.target_from_source, line.points, {t}, {map.path});
    const Points& carried = moved.frames.front();
    GradedMeasure& measure = graded.emplace_back();
    measure.name = line.name;
    measure.source = line_length(line.points, line.closed);
    measure.carried = line_length(carried, line.closed);
    if (target && line.closed) measure.target = girth_near(*target, carried);
  }
  return graded;
}

std::string grade_csv(const std::vector<GradedMeasure>& measures) {
  std::string text = "measure,source,carried,target\n";
  for (const GradedMeasure& measure : measures)
    text += csv_cell(measure.name) + number(",%.5f", measure.source) + number(",%.5f,", measure.carried) +
            (measure.target ? number("%.5f", *measure.target) : "") + "\n";
  return text;
}

std::string grade_markdown(const std::string& size, const std::string& unit,
                           const std::vector<GradedMeasure>& measures) {
  std::string text = "# " + size + "\n\n";
  text += "| measure" + (unit.empty() ? "" : " (" + unit + ")") +
          " | source | carried | change | target |\n|---|---|---|---|---|\n";
  for (const GradedMeasure& measure : measures)
    text += "| " + measure.name + number(" | %.2f", measure.source) + number(" | %.2f", measure.carried) +
            number(" | %+.2f | ", measure.carried - measure.source) +
            (measure.target ? number("%.2f", *measure.target) : "") + " |\n";
  return text;
}

}  // namespace bespoke
