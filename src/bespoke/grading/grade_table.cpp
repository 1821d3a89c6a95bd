#include "bespoke/grading/grade_table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "bespoke/apply/apply_mapping.h"
#include "bespoke/csv_rows.h"
#include "bespoke/number_format.h"

namespace bespoke {
namespace {

std::string fixed(double value, int decimals, const char* format = "%.*f") {
  char text[400];  // the largest double has 309 digits
  std::snprintf(text, sizeof text, format, decimals, value);
  return text;
}

/// Digits that programs read: more than a float of a model's file has.
std::string number(double value) { return format_number(value, 9); }

std::string markdown_cell(const std::string& text) {
  std::string cell;
  for (const char c : text) cell += c == '|' ? "\\|" : std::string(1, c);
  return cell;
}

std::string measure_heading(const GradedSeries& series) {
  return "| measure" + (series.unit.empty() ? "" : " (" + markdown_cell(series.unit) + ")") + " | source |";
}

/// Whether some measure was found on the own model of every size.
bool have_models(const GradedSeries& series) {
  return std::all_of(series.sizes.begin(), series.sizes.end(), [](const GradedSize& size) {
    return std::any_of(size.measures.begin(), size.measures.end(),
                       [](const GradedMeasure& measure) { return measure.model.has_value(); });
  });
}

}  // namespace

std::vector<GradedMeasure> graded_measures(const std::vector<MeasureLine>& lines, const OpenedMap& map,
                                           double t, const SizeModel* model) {
  const ImageOfPoints image = image_at(*map.elastic, map.target_from_source, t, {map.path});
  std::vector<GradedMeasure> graded;
  for (const MeasureLine& line : lines) {
    GradedMeasure& measure = graded.emplace_back();
    measure.name = line.name;
    measure.source = line_length(line.points, line.closed);
    measure.carried = line_length(image(line.points), line.closed);
    if (model) measure.model = length_on(*model, line, image);
  }
  return graded;
}

int length_decimals(double diagonal) {
  constexpr double shown_share = 1e-4;
  constexpr int most = 9;
  return std::clamp(static_cast<int>(std::ceil(-std::log10(shown_share * diagonal))), 0, most);
}

std::string size_csv(const GradedSize& size) {
  std::string text = "measure,source,model,carried\n";
  for (const GradedMeasure& measure : size.measures)
    text += csv_cell(measure.name) + "," + number(measure.source) + "," +
            (measure.model ? number(*measure.model) : "") + "," + number(measure.carried) + "\n";
  return text;
}

std::string size_markdown(const GradedSeries& series, const GradedSize& size) {
  const auto length = [&](double value) { return fixed(value, series.decimals); };
  std::string text = "# " + size.name + "\n\n" + measure_heading(series) +
                     " model | carried | carried − source |\n|---|---|---|---|---|\n";
  for (const GradedMeasure& measure : size.measures)
    text += "| " + markdown_cell(measure.name) + " | " + length(measure.source) + " | " +
            (measure.model ? length(*measure.model) : "") + " | " + length(measure.carried) + " | " +
            fixed(measure.carried - measure.source, series.decimals, "%+.*f") + " |\n";
  return text;
}

std::string series_csv(const GradedSeries& series) {
  std::string text = "measure,on,source";
  for (const GradedSize& size : series.sizes) text += "," + csv_cell(size.name);
  text += "\n";
  const std::size_t count = series.sizes.empty() ? 0 : series.sizes.front().measures.size();
  for (std::size_t i = 0; i < count; ++i) {
    const GradedMeasure& first = series.sizes.front().measures[i];
    std::string model = csv_cell(first.name) + ",model," + number(first.source);
    std::string carried = csv_cell(first.name) + ",carried," + number(first.source);
    for (const GradedSize& size : series.sizes) {
      model += "," + (size.measures[i].model ? number(*size.measures[i].model) : "");
      carried += "," + number(size.measures[i].carried);
    }
    text += (have_models(series) ? model + "\n" : "") + carried + "\n";
  }
  return text;
}

std::string series_markdown(const GradedSeries& series) {
  const bool on_models = have_models(series);
  std::string text = on_models ? "Lengths on the models of the sizes.\n\n"
                               : "Lengths on the source, carried to the sizes.\n\n";
  std::string rule = "\n|---|---|";
  text += measure_heading(series);
  for (const GradedSize& size : series.sizes) {
    text += " " + markdown_cell(size.name) + " |";
    rule += "---|";
  }
  text += rule + "\n";
  const std::size_t count = series.sizes.empty() ? 0 : series.sizes.front().measures.size();
  for (std::size_t i = 0; i < count; ++i) {
    const GradedMeasure& first = series.sizes.front().measures[i];
    text += "| " + markdown_cell(first.name) + " | " + fixed(first.source, series.decimals) + " |";
    for (const GradedSize& size : series.sizes) {
      const GradedMeasure& measure = size.measures[i];
      const std::optional<double> length = on_models ? measure.model : measure.carried;
      text += " " + (length ? fixed(*length, series.decimals) : "") + " |";
    }
    text += "\n";
  }
  return text;
}

}  // namespace bespoke
