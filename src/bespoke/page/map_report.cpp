#include "bespoke/page/map_report.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bespoke/base64.h"
#include "bespoke/number_format.h"
#include "bespoke/page/detail/input_quality.h"
#include "bespoke/page/detail/picture.h"
#include "bespoke/page/detail/places.h"
#include "bespoke/page/detail/shown_unit.h"
#include "bespoke/page/detail/vertex_fields.h"
#include "bespoke/page/html_text.h"
#include "bespoke/report/inspection.h"
#include "bespoke/report/quality_report.h"
#include "bespoke/statistics.h"

namespace bespoke {
namespace {

constexpr int picture_size = 560;       // pixels: two beside each other fit a mail
constexpr double largest_shown = 0.99;  // quantile where the colours end
const Vector3 source_colour(0.73, 0.64, 0.55), target_colour(0.62, 0.70, 0.78);  // as the page's

std::string number(double value) { return format_number(value, 3); }

/// Where the colours of a field end, on both sides of 0 for changes.
double reach_of(const VertexField& field) {
  std::vector<double> sizes;
  for (const double value : field.values)
    if (std::isfinite(value)) sizes.push_back(std::abs(value));
  return sizes.empty() ? 1 : nearest_rank(sorted_finite(std::move(sizes)), largest_shown);
}

std::vector<Vector3> colours_of(const VertexField& field, double reach) {
  std::vector<Vector3> colours;
  for (const double value : field.values)
    colours.push_back(field.middle ? colour_of(value, -reach, reach, true)
                                   : colour_of(value, 0, reach, false));
  return colours;
}

class Reporter {
 public:
  explicit Reporter(const ViewInput& input)
      : input_(input),
        chain_(loaded_chain(input.asset.steps)),
        from_source_(input.source),
        from_target_(input.target) {}

  /// All in the source's frame, so that the front of one model is that of the other.
  std::vector<ReportPicture> pictures() {
    std::vector<ReportPicture> result;
    const VertexField distance = distance_field("target_distance", "distance to the target", from_target_,
                                                carried(input_.source.vertices));
    const double reach = reach_of(distance);
    add("surface",
        "the carried source, coloured by its distance to the target, 0 (purple) to " + length(reach) +
            " (yellow)",
        {{chain_(input_.source.vertices), input_.source.faces, colours_of(distance, reach)}}, result);
    if (input_.products.empty()) return result;
    std::vector<PaintedMesh> before{{input_.source.vertices, input_.source.faces, {source_colour}}};
    std::vector<PaintedMesh> after{{inverse(input_.asset.target_from_source) * input_.target.vertices,
                                    input_.target.faces,
                                    {target_colour}}};
    double most = 0;
    std::vector<VertexField> changes;
    for (const NamedProduct& product : input_.products) {
      const Points& x = product.mesh.vertices;
      changes.push_back(clearance_fields(from_source_, from_target_, x, carried(x)).front());
      most = std::max(most, reach_of(changes.back()));
    }
    for (std::size_t i = 0; i < changes.size(); ++i) {
      const TriangleMesh& mesh = input_.products[i].mesh;
      if (mesh.faces.cols() == 0) continue;  // points have no surface to draw
      before.push_back({mesh.vertices, mesh.faces, colours_of(changes[i], most)});
      after.push_back({chain_(mesh.vertices), mesh.faces, colours_of(changes[i], most)});
    }
    const std::string colours = ", coloured by the change of clearance, " + length(-most) +
                                " (blue, nearer) to " + length(most) + " (red, farther)";
    add("source", "the source and its products" + colours, before, result);
    add("target", "the target and the carried products" + colours, after, result);
    return result;
  }

 private:
  Points carried(const Points& x) const { return input_.asset.target_from_source * chain_(x); }

  std::string length(double value) const { return number(value) + " " + shown_unit(input_.asset); }

  static void add(const std::string& name, const std::string& what, const std::vector<PaintedMesh>& meshes,
                  std::vector<ReportPicture>& pictures) {
    pictures.push_back(
        {name + "_front", "From the front: " + what, png(draw(meshes, DrawnFrom::front, picture_size))});
    pictures.push_back(
        {name + "_side", "From the side: " + what, png(draw(meshes, DrawnFrom::side, picture_size))});
  }

  const ViewInput& input_;
  const ElasticChain chain_;
  const SignedDistance from_source_, from_target_;
};

std::string quality_lines(const ViewInput& input, const Progress& progress) {
  const MappingQuality quality = input_quality(input, loaded_chain(input.asset.steps), progress);
  return quality_text(quality, product_names(input), input.asset.record.unit);
}

}  // namespace

MapReport map_report(const ViewInput& input, const Progress& progress) {
  require_valid(input.source, "source");
  require_valid(input.target, "target");
  MapReport report{input.title,
                   input.command,
                   Reporter(input).pictures(),
                   quality_lines(input, progress),
                   "",
                   inspection_text(input.asset)};
  for (const Place& place : places_to_see(input.asset, input.source, input.findings))
    report.places += place.kind + ": " + place.text + "\n";
  return report;
}

std::string report_markdown(const MapReport& report, const std::string& pictures_prefix) {
  std::string text = "# " + report.title + "\n\n";
  for (const ReportPicture& picture : report.pictures)
    text += "![" + picture.caption + "](" + pictures_prefix + picture.name + ".png)\n\n" + picture.caption +
            ".\n\n";
  const auto block = [&](const char* title, const std::string& lines) {
    if (!lines.empty())
      text +=
          std::string("## ") + title + "\n\n```\n" + lines + (lines.back() == '\n' ? "" : "\n") + "```\n\n";
  };
  block("Measures", report.quality);
  block("Worth a look", report.places);
  block("The map", report.info);
  block("How to reproduce", report.command);
  return text;
}

std::string report_html(const MapReport& report) {
  std::string text =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><title>" +
      escaped(report.title) +
      "</title>\n<style>body{font:15px/1.5 system-ui,sans-serif;max-width:1180px;margin:1.5rem "
      "auto;padding:0 1rem}"
      "figure{display:inline-block;margin:0 .5rem 1rem 0;max-width:100%}img{max-width:100%;border:1px solid "
      "#d0d7de}"
      "figcaption{max-width:560px;color:#57606a}pre{background:#f4f5f7;color:#1b1f24;padding:.8rem;overflow-"
      "x:auto}</style></head><body>\n<h1>" +
      escaped(report.title) + "</h1>\n";
  for (const ReportPicture& picture : report.pictures)
    text += "<figure><img alt=\"" + escaped(picture.caption) + "\" src=\"data:image/png;base64," +
            base64(picture.png) + "\"><figcaption>" + escaped(picture.caption) + ".</figcaption></figure>\n";
  const auto block = [&](const char* title, const std::string& lines) {
    if (!lines.empty()) text += std::string("<h2>") + title + "</h2>\n<pre>" + escaped(lines) + "</pre>\n";
  };
  block("Measures", report.quality);
  block("Worth a look", report.places);
  block("The map", report.info);
  block("How to reproduce", report.command);
  return text + "</body></html>\n";
}

}  // namespace bespoke
