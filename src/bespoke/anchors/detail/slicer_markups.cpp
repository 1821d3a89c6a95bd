#include "bespoke/anchors/detail/slicer_markups.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "bespoke/anchors/detail/patient_system.h"
#include "bespoke/error.h"

namespace bespoke {
namespace {

using Json = nlohmann::ordered_json;

const Json& list_of(const Json& owner, const char* key, const std::string& where) {
  const auto list = owner.find(key);
  if (list == owner.end() || !list->is_array()) throw FormatError(where + ": has no list \"" + key + "\"");
  return *list;
}

std::string text_under(const Json& owner, const char* key, const char* otherwise, const std::string& where) {
  const auto value = owner.find(key);
  if (value == owner.end()) return otherwise;
  if (!value->is_string()) throw FormatError(where + ": \"" + key + "\" is no text");
  return value->get<std::string>();
}

Vector3 position_of(const Json& control, const std::string& where) {
  const auto at = control.find("position");
  if (at == control.end() || !at->is_array() || at->size() != 3 ||
      !std::all_of(at->begin(), at->end(), [](const Json& x) { return x.is_number(); }))
    throw FormatError(where + ": \"position\" is not three numbers");
  return {(*at)[0].get<double>(), (*at)[1].get<double>(), (*at)[2].get<double>()};
}

std::vector<NamedPoint> control_points(const Json& markup, const std::string& where, PatientSystem models) {
  const PatientSystem system =
      patient_system_named(text_under(markup, "coordinateSystem", "LPS", where), where);
  std::vector<NamedPoint> points;
  int number = 0;
  for (const Json& control : list_of(markup, "controlPoints", where)) {
    const std::string place = where + ": control point " + std::to_string(number++);
    if (!control.is_object()) throw FormatError(place + " is no object");
    if (text_under(control, "positionStatus", "defined", place) != "defined") continue;
    points.push_back(
        {text_under(control, "label", "", place), in_system(position_of(control, place), system, models)});
  }
  return points;
}

NamedLine line_through(const std::vector<NamedPoint>& points, const Json& markup, const std::string& where) {
  NamedLine line{text_under(markup, "name", "", where), Points(3, static_cast<Eigen::Index>(points.size())),
                 markup["type"] == "ClosedCurve"};
  for (std::size_t i = 0; i < points.size(); ++i) line.points.col(static_cast<Eigen::Index>(i)) = points[i].x;
  const bool has_length = std::any_of(points.begin(), points.end(),
                                      [&](const NamedPoint& point) { return point.x != points.front().x; });
  if (!has_length) throw FormatError(where + ": a curve has two control points at different places at least");
  return line;
}

Json control_json(std::size_t index, const std::string* label, const Vector3& x) {
  Json control = {{"id", std::to_string(index + 1)}};
  if (label != nullptr) control["label"] = *label;
  control["position"] = {x.x(), x.y(), x.z()};
  control["positionStatus"] = "defined";
  return control;
}

Json markup_json(const char* type, const std::string& name, Json controls, PatientSystem models) {
  Json markup = {{"type", type}};
  if (!name.empty()) markup["name"] = name;
  markup["coordinateSystem"] = models == PatientSystem::lps ? "LPS" : "RAS";
  markup["coordinateUnits"] = "mm";
  markup["controlPoints"] = std::move(controls);
  return markup;
}

Json points_json(const std::vector<NamedPoint>& points, PatientSystem models) {
  Json controls = Json::array();
  for (std::size_t i = 0; i < points.size(); ++i)
    controls.push_back(control_json(i, &points[i].name, points[i].x));
  return markup_json("Fiducial", "", std::move(controls), models);
}

Json line_json(const NamedLine& line, PatientSystem models) {
  Json controls = Json::array();
  for (Eigen::Index i = 0; i < line.points.cols(); ++i)
    controls.push_back(control_json(static_cast<std::size_t>(i), nullptr, line.points.col(i)));
  return markup_json(line.closed ? "ClosedCurve" : "Curve", line.name, std::move(controls), models);
}

}  // namespace

FileSide parse_markups(const std::string& text, const std::string& file, PatientSystem models) {
  const Json document = Json::parse(text);
  if (!document.is_object()) throw FormatError(file + ": is no object with a list \"markups\"");
  FileSide side;
  int number = 0;
  for (const Json& markup : list_of(document, "markups", file)) {
    const std::string where = file + ": markup " + std::to_string(number++);
    if (!markup.is_object()) throw FormatError(where + " is no object");
    const std::string type = text_under(markup, "type", "Fiducial", where);
    if (type != "Fiducial" && type != "Curve" && type != "ClosedCurve")
      throw FormatError(where + ": is of type \"" + type.substr(0, 40) +
                        "\"; only Fiducial, Curve and ClosedCurve are points and curves");
    const std::vector<NamedPoint> points = control_points(markup, where, models);
    if (type == "Fiducial")
      side.points.insert(side.points.end(), points.begin(), points.end());
    else
      side.lines.push_back(line_through(points, markup, where));
  }
  return side;
}

std::string markups_text(const FileSide& side, PatientSystem models) {
  Json document;
  document["@schema"] =
      "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/"
      "markups-schema-v1.0.3.json#";
  document["markups"] = Json::array({points_json(side.points, models)});
  for (const NamedLine& line : side.lines) document["markups"].push_back(line_json(line, models));
  return document.dump(1) + "\n";
}

}  // namespace bespoke
