#include "bespoke/grading/measures.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <initializer_list>
#include <set>
#include <string_view>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/grading/detail/surface_line.h"
#include "bespoke/json_reason.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/pipeline/summary_json.h"
#include "bespoke/text_lines.h"

namespace bespoke {
namespace {

// Of the diagonal: chords of a wrist on a whole body lose a thousandth of its girth.
constexpr double line_spacing = 0.002;

void require_keys(const Json& object, std::initializer_list<std::string_view> known) {
  for (const auto& [key, value] : object.items())
    if (std::find(known.begin(), known.end(), key) == known.end())
      throw FormatError("unknown key \"" + key + "\"");
}

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

Plane plane_of(const Json& json) {
  if (!json.is_object() || !json.contains("point") || !json.contains("normal"))
    throw FormatError("a plane has a \"point\" and a \"normal\"");
  require_keys(json, {"point", "normal"});
  const Plane plane{vector_of(json["point"]), vector_of(json["normal"])};
  if (!(plane.normal.norm() > 0)) throw FormatError("the normal of its plane is zero");
  return plane;
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

std::string name_of(const Json& entry) {
  if (!entry.is_object() || !entry.contains("name") || !entry["name"].is_string())
    throw FormatError("needs a \"name\"");
  const std::string name = entry["name"];
  const bool printable = std::none_of(name.begin(), name.end(), [](unsigned char c) { return c < 0x20; });
  if (name.empty() || !printable) throw FormatError("its name is empty or holds a control character");
  return name;
}

Measure measure_of(const Json& entry) {
  const std::string name = name_of(entry);
  try {
    require_keys(entry, {"name", "plane", "loop", "path"});
    if (entry.size() != 2) throw FormatError("needs a \"plane\", a \"loop\" or a \"path\", and only one");
    if (entry.contains("plane")) return {name, plane_of(entry["plane"])};
    const bool closed = entry.contains("loop");
    return {name, line_of(entry[closed ? "loop" : "path"], closed)};
  } catch (const FormatError& error) {
    throw FormatError("\"" + name + "\": " + error.what());
  }
}

Json parse_file(const std::filesystem::path& path) {
  const std::string text = read_text_file(path);
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    throw FormatError(path.string() + ": " + json_reason(error.what()));
  }
}

Points corners_of(const AnchorLine& line, const AnchorPlaces& anchors) {
  Points corners(3, static_cast<Eigen::Index>(line.points.size()));
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    const std::string* name = std::get_if<std::string>(&line.points[i]);
    if (name && !anchors.contains(*name)) throw InvalidInput("there is no anchor \"" + *name + "\"");
    corners.col(static_cast<Eigen::Index>(i)) = name ? anchors.at(*name) : std::get<Vector3>(line.points[i]);
  }
  return corners;
}

Points line_over(const TriangleMesh& mesh, const ClosestPointTree& surface, const Points& corners,
                 bool closed) {
  return surface_line(surface, corners, {closed, line_spacing * diagonal(mesh.vertices)});
}

MeasureLine line_of(const Measure& measure, const TriangleMesh& source, const ClosestPointTree& surface,
                    const AnchorPlaces& anchors) {
  if (const AnchorLine* line = std::get_if<AnchorLine>(&measure.what))
    return {measure.name, line_over(source, surface, corners_of(*line, anchors), line->closed), line->closed,
            *line};
  const std::optional<Points> section = section_about_point(source, std::get<Plane>(measure.what));
  if (!section) throw InvalidInput("its plane cuts the source in no closed line");
  return {measure.name, *section, true, std::nullopt};
}

/// The plane with the least sum of squared distances from the points (3×n), at their middle.
Plane plane_near(const Points& points) {
  const Vector3 middle = points.rowwise().mean();
  const Points spread = points.colwise() - middle;
  const Matrix3 moments = spread * spread.transpose();
  return {middle, Eigen::SelfAdjointEigenSolver<Matrix3>(moments).eigenvectors().col(0)};
}

/// The line with its own points where the map takes them.
AnchorLine moved(AnchorLine line, const ImageOfPoints& image) {
  for (auto& point : line.points)
    if (const Vector3* place = std::get_if<Vector3>(&point)) point = Vector3(image(*place));
  return line;
}

}  // namespace

Measures read_measures(const std::filesystem::path& path) {
  const Json json = parse_file(path);
  if (!json.is_object() || !json.contains("measures") || !json["measures"].is_array())
    throw FormatError(path.string() + ": is no JSON object with a list \"measures\"");
  if (json["measures"].empty()) throw FormatError(path.string() + ": the list \"measures\" is empty");
  Measures sheet;
  try {
    require_keys(json, {"units", "measures"});
    if (json.contains("units")) sheet.unit = json["units"].get<std::string>();
  } catch (const FormatError& error) {
    throw FormatError(path.string() + ": " + error.what());
  } catch (const Json::type_error&) {
    throw FormatError(path.string() + ": \"units\" must be a text");
  }
  std::set<std::string> names;
  for (const Json& entry : json["measures"]) {
    const std::string place = path.string() + ": measure " + std::to_string(sheet.measures.size() + 1) + " ";
    try {
      sheet.measures.push_back(measure_of(entry));
    } catch (const FormatError& error) {
      throw FormatError(place + error.what());
    }
    const std::string& name = sheet.measures.back().name;
    if (!names.insert(name).second) throw FormatError(place + "is a second \"" + name + "\"");
  }
  return sheet;
}

std::vector<MeasureLine> measure_lines(const std::vector<Measure>& measures, const TriangleMesh& source,
                                       const AnchorPlaces& anchors) {
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

std::optional<double> length_on(const SizeModel& model, const MeasureLine& line, const ImageOfPoints& image) {
  if (!line.through) {
    const std::optional<Points> section = section_about_point(model.mesh, plane_near(image(line.points)));
    return section ? std::optional(line_length(*section, true)) : std::nullopt;
  }
  const Points corners = corners_of(moved(*line.through, image), model.anchors);
  try {
    return line_length(line_over(model.mesh, ClosestPointTree(model.mesh), corners, line.closed),
                       line.closed);
  } catch (const InvalidInput&) {  // no way over the model
    return std::nullopt;
  }
}

}  // namespace bespoke
