#include "bespoke/anchors/detail/point_files.h"

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <sstream>

#include "bespoke/anchors/detail/meshlab_points.h"
#include "bespoke/anchors/detail/patient_system.h"
#include "bespoke/anchors/detail/point_text.h"
#include "bespoke/anchors/detail/slicer_markups.h"
#include "bespoke/csv_rows.h"
#include "bespoke/error.h"
#include "bespoke/json_reason.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/text_lines.h"

namespace bespoke {
namespace {

using Json = nlohmann::ordered_json;

std::string triple(const Vector3& x, const char* separator) {
  return all_digits(x.x()) + separator + all_digits(x.y()) + separator + all_digits(x.z());
}

// ---- 3D Slicer's older fiducials

std::vector<NamedPoint> parse_fiducials(const std::string& text, const std::string& file,
                                        PatientSystem models) {
  // What files without the line mean: 3D Slicer wrote RAS before it wrote the line.
  PatientSystem system = PatientSystem::ras;
  std::vector<NamedPoint> points;
  const std::vector<std::string_view> rows = text_lines(text);
  constexpr std::string_view mark = "# CoordinateSystem = ";
  for (std::size_t line = 0; line < rows.size(); ++line) {
    const std::string where = file + ":" + std::to_string(line + 1);
    const std::string_view row = rows[line];
    if (row.starts_with(mark)) system = patient_system_named(std::string(row.substr(mark.size())), where);
    if (row.find_first_not_of(" \t") == std::string_view::npos || row[0] == '#') continue;
    const CsvRow cells = csv_row(row, ',');
    if (!cells.is_closed) throw FormatError(where + ": a quote that does not end in its line");
    const std::vector<std::string> fields = csv_texts(cells);
    constexpr std::size_t label_column = 11;
    if (fields.size() < 4) throw FormatError(where + ": fewer than four columns");
    points.push_back({fields.size() > label_column ? fields[label_column] : "",
                      in_system({finite_number(fields[1], where), finite_number(fields[2], where),
                                 finite_number(fields[3], where)},
                                system, models)});
  }
  return points;
}

std::string fiducials_text(const std::vector<NamedPoint>& points, PatientSystem models) {
  std::string text = "# Markups fiducial file version = 5.0\n# CoordinateSystem = ";
  text += models == PatientSystem::lps ? "LPS" : "RAS";
  text += "\n# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n";
  for (std::size_t i = 0; i < points.size(); ++i) {
    // A comma ends the column except in quotes.
    text += std::to_string(i + 1) + "," + triple(points[i].x, ",") + ",0,0,0,1,1,1,0," +
            csv_cell(points[i].name) + ",,\n";
  }
  return text;
}

// ---- Landmark Editor

std::vector<NamedPoint> parse_landmarks(const std::string& text, const std::string& file) {
  const std::vector<std::string_view> rows = text_lines(text);
  std::vector<NamedPoint> points;
  std::size_t promised = 0;
  for (std::size_t line = 0; line < rows.size(); ++line) {
    const std::string where = file + ":" + std::to_string(line + 1);
    std::istringstream stream{std::string(rows[line])};
    std::vector<std::string> words;
    for (std::string word; stream >> word;) words.push_back(word);
    if (words.empty() || words[0] == "Version") continue;
    if (words.size() == 1 && points.empty()) {
      promised = static_cast<std::size_t>(finite_number(words[0], where));
      continue;
    }
    if (words.size() != 4) throw FormatError(where + ": a point is a name and three numbers");
    points.push_back(
        {words[0],
         {finite_number(words[1], where), finite_number(words[2], where), finite_number(words[3], where)}});
  }
  if (points.size() != promised)
    throw FormatError(file + ": " + std::to_string(points.size()) + " points, but it says " +
                      std::to_string(promised));
  return points;
}

/// With an underscore for every run of blanks.
std::string joined_words(const std::string& text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto is_blank = [&](std::size_t k) {
      return std::isspace(static_cast<unsigned char>(text[k])) != 0;
    };
    if (!is_blank(i))
      result += text[i];
    else if (i == 0 || !is_blank(i - 1))
      result += '_';
  }
  return result;
}

std::string landmarks_text(const std::vector<NamedPoint>& points) {
  std::string text = "Version 1.0\n" + std::to_string(points.size()) + "\n";
  for (std::size_t i = 0; i < points.size(); ++i) {
    // Names are words there.
    std::string name = joined_words(points[i].name);
    if (name.empty()) name = "S" + std::to_string(i);
    text += name + " " + triple(points[i].x, " ") + "\n";
  }
  return text;
}

// ---- Wrap

Vector3 point_of(const TriangleMesh& mesh, const Json& entry, const std::string& where) {
  const auto is_number = [](const Json& value) { return value.is_number(); };
  if (!entry.is_array() || entry.size() < 3 || !std::all_of(entry.begin(), entry.end(), is_number) ||
      !entry[0].is_number_integer())
    throw FormatError(where + " is not [triangle, u, v]");
  const auto face = entry[0].get<Eigen::Index>();
  const double u = entry[1].get<double>(), v = entry[2].get<double>();
  if (face < 0 || face >= mesh.faces.cols())
    throw FormatError(where + ": triangle " + std::to_string(face) + " of " +
                      std::to_string(mesh.faces.cols()));
  const auto corner = [&](int k) { return mesh.vertices.col(mesh.faces(k, face)); };
  return (1 - u - v) * corner(0) + u * corner(1) + v * corner(2);
}

std::vector<NamedPoint> parse_wrap(const std::string& text, const std::string& file,
                                   const TriangleMesh& mesh) {
  const Json document = Json::parse(text);
  if (!document.is_array()) throw FormatError(file + ": is no list of [triangle, u, v]");
  std::vector<NamedPoint> points;
  for (const Json& entry : document)
    points.push_back({"", point_of(mesh, entry, file + ": point " + std::to_string(points.size()))});
  return points;
}

std::string wrap_text(const std::vector<NamedPoint>& points, const TriangleMesh& mesh) {
  const ClosestPointTree tree(mesh);
  Json list = Json::array();
  for (const NamedPoint& point : points) {
    const SurfacePoint near = *tree.closest(point.x);
    list.push_back({near.face, near.barycentric[1], near.barycentric[2]});
  }
  return list.dump() + "\n";
}

}  // namespace

FileSide parse_side(const std::string& text, AnchorFormat format, const std::string& file,
                    const TriangleMesh* mesh, PatientSystem models) {
  if (format == AnchorFormat::meshlab) return {parse_meshlab(text, file)};
  if (format == AnchorFormat::fiducials) return {parse_fiducials(text, file, models)};
  if (format == AnchorFormat::landmarks) return {parse_landmarks(text, file)};
  try {
    if (format == AnchorFormat::markups) return parse_markups(text, file, models);
    return {parse_wrap(text, file, *mesh)};
  } catch (const Json::exception& error) {
    throw FormatError(file + ": not valid JSON: " + json_reason(error.what()));
  }
}

std::string side_text(const FileSide& side, AnchorFormat format, const TriangleMesh* mesh,
                      PatientSystem models) {
  if (format == AnchorFormat::meshlab) return meshlab_text(side.points);
  if (format == AnchorFormat::fiducials) return fiducials_text(side.points, models);
  if (format == AnchorFormat::landmarks) return landmarks_text(side.points);
  if (format == AnchorFormat::markups) return markups_text(side, models);
  return wrap_text(side.points, *mesh);
}

}  // namespace bespoke
