#include "bespoke/grading/measures.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <fstream>
#include <limits>
#include <set>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/pipeline/summary_json.h"

namespace bespoke {
namespace {

// Of the diagonal, between points of a line over the surface: chords of a limb lose some thousandths.
constexpr double line_spacing = 0.01;

Vector3 vector_of(const Json& json) {
  if (!json.is_array() || json.size() != 3) throw FormatError("a point must be three numbers");
  Vector3 vector;
  for (int i = 0; i < 3; ++i) {
    const Json& value = json[static_cast<std::size_t>(i)];
    if (!value.is_number()) throw FormatError("a point must be three numbers");
    vector[i] = value.get<double>();
  }
  return vector;
}

AnchorLine line_of(const Json& json, bool closed) {
  AnchorLine line{{}, closed};
  if (!json.is_array() || json.size() < (closed ? 3u : 2u))
    throw FormatError("a loop needs three points or more, a path two");
  for (const Json& point : json) {
    if (point.is_string())
      line.points.emplace_back(point.get<std::string>());
    else
      line.points.emplace_back(vector_of(point));
  }
  return line;
}

Measure measure_of(const Json& json) {
  if (json.contains("plane")) {
    const Json& plane = json["plane"];
    if (!plane.is_object() || !plane.contains("point") || !plane.contains("normal"))
      throw FormatError("a plane has a \"point\" and a \"normal\"");
    return {json["name"], Plane{vector_of(plane["point"]), vector_of(plane["normal"])}};
  }
  if (json.contains("loop")) return {json["name"], line_of(json["loop"], true)};
  if (json.contains("path")) return {json["name"], line_of(json["path"], false)};
  throw FormatError("needs a \"plane\", a \"loop\" or a \"path\"");
}

Points line_points(const AnchorLine& line, const TriangleMesh& source, const ClosestPointTree& surface,
                   const std::map<std::string, Vector3>& anchors) {
  std::vector<Vector3> corners;
  for (const auto& point : line.points) {
    const std::string* name = std::get_if<std::string>(&point);
    if (name && !anchors.contains(*name)) throw InvalidInput("there is no anchor \"" + *name + "\"");
    corners.push_back(name ? anchors.at(*name) : std::get<Vector3>(point));
  }
  const double spacing = line_spacing * diagonal(source.vertices);
  std::vector<Vector3> chain;
  for (std::size_t i = 0; i + 1 < corners.size() + (line.closed ? 1 : 0); ++i) {
    const Vector3 from = corners[i], to = corners[(i + 1) % corners.size()];
    const int pieces = std::max(1, static_cast<int>(std::ceil((to - from).norm() / spacing)));
    for (int k = 0; k < pieces; ++k) chain.push_back(from + (to - from) * k / pieces);
  }
  if (!line.closed) chain.push_back(corners.back());
  Points points(3, static_cast<Eigen::Index>(chain.size()));
  for (std::size_t i = 0; i < chain.size(); ++i)
    points.col(static_cast<Eigen::Index>(i)) = surface.closest(chain[i])->point;
  return points;
}

MeasureLine line_of(const Measure& measure, const TriangleMesh& source, const ClosestPointTree& surface,
                    const std::map<std::string, Vector3>& anchors) {
  if (const AnchorLine* line = std::get_if<AnchorLine>(&measure.what))
    return {measure.name, line_points(*line, source, surface, anchors), line->closed};
  const std::vector<Points> sections = closed_sections(source, std::get<Plane>(measure.what));
  if (sections.empty()) throw InvalidInput("its plane cuts the source in no closed line");
  return {measure.name, sections.front(), true};
}

}  // namespace

Measures read_measures(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw FileError(path.string() + ": cannot be read");
  const Json json = Json::parse(file, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object() || !json.contains("measures") || !json["measures"].is_array())
    throw FormatError(path.string() + ": is no JSON object with a list \"measures\"");
  Measures measures{json.contains("unit") && json["unit"].is_string() ? json["unit"].get<std::string>() : "",
                    {}};
  std::set<std::string> names;
  for (const Json& entry : json["measures"]) {
    const std::string place = path.string() + ": measure " + std::to_string(measures.measures.size() + 1);
    if (!entry.is_object() || !entry.contains("name") || !entry["name"].is_string())
      throw FormatError(place + ": needs a \"name\"");
    const std::string name = entry["name"];
    if (!names.insert(name).second) throw FormatError(place + ": a second \"" + name + "\"");
    try {
      measures.measures.push_back(measure_of(entry));
    } catch (const FormatError& error) {
      throw FormatError(place + " \"" + name + "\": " + error.what());
    }
  }
  return measures;
}

std::vector<MeasureLine> measure_lines(const std::vector<Measure>& measures, const TriangleMesh& source,
                                       const std::map<std::string, Vector3>& anchors) {
  const ClosestPointTree surface(source);
  std::vector<MeasureLine> lines;
  for (const Measure& measure : measures) {
    try {
      lines.push_back(line_of(measure, source, surface, anchors));
    } catch (const InvalidInput& error) {
      throw InvalidInput("measure \"" + measure.name + "\": " + error.what());
    }
  }
  return lines;
}

double girth_near(const TriangleMesh& mesh, const Points& points) {
  const Vector3 centre = points.rowwise().mean();
  const Points spread = points.colwise() - centre;
  const Matrix3 moments = spread * spread.transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix3> axes(moments);
  double girth = 0, nearest = std::numeric_limits<double>::infinity();
  for (const Points& section : closed_sections(mesh, {centre, axes.eigenvectors().col(0)})) {
    const double distance = (section.rowwise().mean() - centre).norm();
    if (distance >= nearest) continue;
    nearest = distance;
    girth = line_length(section, true);
  }
  return girth;
}

}  // namespace bespoke
