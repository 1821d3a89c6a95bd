#include "bespoke/anchors/detail/anchor_json.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/json_reason.h"

namespace bespoke {
namespace {

using ParsedJson = nlohmann::json;

double json_number(const ParsedJson& value, const std::string& where) {
  if (!value.is_number()) throw FormatError(where + " is " + value.type_name() + ", not a number");
  const double number = value.get<double>();
  if (!std::isfinite(number)) throw FormatError(where + " is not finite");
  return number;
}

Vector3 json_point(const ParsedJson& pair, const char* key, const std::string& where) {
  const auto found = pair.find(key);
  if (found == pair.end()) throw FormatError(where + ": key \"" + key + "\" is missing");
  if (!found->is_array() || found->size() != 3)
    throw FormatError(where + ": \"" + key + "\" must be an array of three numbers");
  Vector3 point;
  for (int axis = 0; axis < 3; ++axis) {
    const std::string at = where + ": \"" + key + "\"[" + std::to_string(axis) + "]";
    point[axis] = json_number((*found)[static_cast<std::size_t>(axis)], at);
    require_coordinate(point[axis], at);
  }
  return point;
}

/// Of a pair, a curve or a patch; empty without one.
std::string json_name(const ParsedJson& value, const std::string& position) {
  if (!value.is_object()) throw FormatError(position + " is " + value.type_name() + ", not an object");
  const auto name = value.find("name");
  if (name == value.end()) return "";
  if (!name->is_string())
    throw FormatError(position + ": \"name\" is " + name->type_name() + ", not a string");
  require_printable(name->get<std::string>(), position);
  return name->get<std::string>();
}

std::string named_place(const std::string& position, const std::string& name) {
  return name.empty() ? position : position + " (\"" + name + "\")";
}

/// False without it.
bool json_flag(const ParsedJson& value, const char* key, const std::string& where) {
  const auto flag = value.find(key);
  if (flag == value.end()) return false;
  if (!flag->is_boolean()) throw FormatError(where + ": \"" + key + "\" must be true or false");
  return flag->get<bool>();
}

AnchorPair json_pair(const ParsedJson& value, const std::string& position) {
  AnchorPair pair;
  pair.name = json_name(value, position);
  const std::string where = named_place(position, pair.name);
  pair.a = json_point(value, "a", where);
  pair.b = json_point(value, "b", where);
  if (const auto weight = value.find("weight"); weight != value.end()) {
    pair.weight = json_number(*weight, where + ": \"weight\"");
    if (!(pair.weight > 0))
      throw FormatError(where + ": \"weight\" is " + weight->dump() + ", but must be > 0");
  }
  if (const auto sigma = value.find("sigma"); sigma != value.end()) {
    pair.sigma = json_number(*sigma, where + ": \"sigma\"");
    if (!(*pair.sigma >= 0))
      throw FormatError(where + ": \"sigma\" is " + sigma->dump() + ", but must be >= 0");
  }
  require_one_accuracy(pair, where);
  return pair;
}

/// At least two points, not all at one place.
Points json_polyline(const ParsedJson& owner, const char* key, const std::string& where) {
  const auto found = owner.find(key);
  if (found == owner.end()) throw FormatError(where + ": key \"" + key + "\" is missing");
  if (!found->is_array() || found->size() < 2)
    throw FormatError(where + ": \"" + key + "\" must be an array of two points at least");
  Points points(3, static_cast<Eigen::Index>(found->size()));
  for (std::size_t i = 0; i < found->size(); ++i)
    points.col(static_cast<Eigen::Index>(i)) =
        json_point({{key, (*found)[i]}}, key, where + ": point " + std::to_string(i));
  for (Eigen::Index i = 1; i < points.cols(); ++i)
    if (points.col(i) != points.col(0)) return points;
  throw FormatError(where + ": \"" + key + "\" has all its points at one place");
}

std::vector<std::pair<int, int>> json_fixed(const ParsedJson& list, const AnchorCurve& curve,
                                            const std::string& where) {
  const std::string rule = where +
                           ": \"fixed\" must be an array of [i, j], a point of a and one of b, by their "
                           "numbers from 0, rising on both sides";
  if (!list.is_array()) throw FormatError(rule);
  std::vector<std::pair<int, int>> fixed;
  for (const ParsedJson& entry : list) {
    const auto is_number = [](const ParsedJson& value, Eigen::Index count) {
      return value.is_number_unsigned() && value.get<std::uint64_t>() < static_cast<std::uint64_t>(count);
    };
    if (!entry.is_array() || entry.size() != 2 || !is_number(entry[0], curve.a.cols()) ||
        !is_number(entry[1], curve.b.cols()))
      throw FormatError(rule);
    fixed.emplace_back(entry[0].get<int>(), entry[1].get<int>());
    const std::size_t last = fixed.size() - 1;
    if (last > 0 &&
        !(fixed[last - 1].first < fixed[last].first && fixed[last - 1].second < fixed[last].second))
      throw FormatError(rule);
  }
  return fixed;
}

AnchorCurve json_curve(const ParsedJson& value, const std::string& position) {
  AnchorCurve curve;
  curve.name = json_name(value, position);
  const std::string where = named_place(position, curve.name);
  curve.a = json_polyline(value, "a", where);
  curve.b = json_polyline(value, "b", where);
  curve.closed = json_flag(value, "closed", where);
  if (const auto fixed = value.find("fixed"); fixed != value.end())
    curve.fixed = json_fixed(*fixed, curve, where);
  return curve;
}

// ---- patches

constexpr const char* side_rule =
    R"( must be {"border": [[x, y, z], …]}, a closed line, or {"faces": [i, …]}, numbers from 0)";

std::vector<int> json_faces(const ParsedJson& list, const std::string& where) {
  if (!list.is_array() || list.empty())
    throw FormatError(where + ": \"faces\" must be an array of one face at least, by their numbers from 0");
  std::vector<int> faces;
  for (const ParsedJson& face : list) {
    if (!face.is_number_unsigned() || face.get<std::uint64_t>() > std::numeric_limits<int>::max())
      throw FormatError(where + ": \"faces\" holds " + face.dump() + ", which is no number of a face");
    faces.push_back(face.get<int>());
  }
  return faces;
}

/// A last point at the place of the first says once more that the line is closed.
Points json_border(const ParsedJson& side, const std::string& where) {
  constexpr Eigen::Index min_points = 3;
  if (const auto closed = side.find("closed"); closed != side.end() && *closed != true)
    throw FormatError(where + ": \"closed\" is " + closed->dump() +
                      ", but a border goes round its patch; leave \"closed\" out and lead the line back to "
                      "its first point, or give \"faces\"");
  Points border = json_polyline(side, "border", where);
  if (border.col(0) == border.col(border.cols() - 1)) border.conservativeResize(3, border.cols() - 1);
  if (border.cols() < min_points)
    throw FormatError(where + ": \"border\" has " + std::to_string(border.cols()) +
                      " points; a line around a patch has three at least");
  return border;
}

/// Empty where the patch has none.
PatchSide json_side(const ParsedJson& patch, const char* key, const std::string& position) {
  const auto side = patch.find(key);
  if (side == patch.end()) return {};
  const std::string where = position + ": \"" + key + '"';
  if (!side->is_object() || side->contains("border") == side->contains("faces"))
    throw FormatError(where + side_rule + (side->is_object() ? "; one of them" : ""));
  if (side->contains("faces")) return {Points(3, 0), json_faces((*side)["faces"], where)};
  return {json_border(*side, where), {}};
}

AnchorPatch json_patch(const ParsedJson& value, const std::string& position) {
  AnchorPatch patch;
  patch.name = json_name(value, position);
  const std::string where = named_place(position, patch.name);
  patch.a = json_side(value, "a", where);
  patch.b = json_side(value, "b", where);
  patch.exclude = json_flag(value, "exclude", where);
  if (patch.a.is_empty() && patch.b.is_empty())
    throw FormatError(where + ": has neither \"a\" nor \"b\"; give the part of the source, of the target, " +
                      (patch.exclude ? "or of both" : "and say with \"exclude\": true if it has no other"));
  if (!patch.exclude && (patch.a.is_empty() || patch.b.is_empty()))
    throw FormatError(where + ": \"" + (patch.a.is_empty() ? "a" : "b") +
                      "\" is missing; only a patch with \"exclude\": true may lie on one model alone");
  return patch;
}

// ---- the whole

/// The array under a key; empty without it.
const ParsedJson& json_list(const ParsedJson& document, const char* key, const std::string& file) {
  static const ParsedJson none = ParsedJson::array();
  const auto list = document.find(key);
  if (list == document.end()) return none;
  if (!list->is_array())
    throw FormatError(file + ": \"" + key + "\" is " + list->type_name() + ", not an array");
  return *list;
}

}  // namespace

void require_coordinate(double number, const std::string& where) {
  if (!(std::abs(number) <= static_cast<double>(std::numeric_limits<float>::max())))
    throw FormatError(where + " is not finite in single precision");
}

void require_printable(const std::string& name, const std::string& where) {
  constexpr std::size_t longest = 200;
  const bool printable = std::none_of(name.begin(), name.end(),
                                      [](unsigned char letter) { return letter < 0x20 || letter == 0x7F; });
  if (!printable) throw FormatError(where + ": the name holds a control character");
  if (name.size() > longest)
    throw FormatError(where + ": the name has " + std::to_string(name.size()) + " bytes, at most " +
                      std::to_string(longest) + " are allowed");
}

void require_one_accuracy(const AnchorPair& pair, const std::string& where) {
  if (pair.sigma && std::isfinite(pair.weight))
    throw FormatError(where + ": has both a weight and a sigma; give one of them");
}

Anchors parse_anchor_json(const std::string& text, const std::string& file) {
  ParsedJson document;
  try {
    document = ParsedJson::parse(text);
  } catch (const ParsedJson::exception& error) {
    throw FormatError(file + ": not valid JSON: " + json_reason(error.what()));
  }
  if (!document.is_object()) throw FormatError(file + ": must be an object with a key \"pairs\"");
  Anchors anchors;
  if (const auto units = document.find("units"); units != document.end()) {
    if (!units->is_string())
      throw FormatError(file + ": \"units\" is " + units->type_name() + ", not a string");
    anchors.unit = units->get<std::string>();
    require_printable(anchors.unit, file + ": \"units\"");
  }
  if (!document.contains("pairs") && !document.contains("curves") && !document.contains("patches"))
    throw FormatError(file + ": key \"pairs\" is missing");
  const ParsedJson& pairs = json_list(document, "pairs", file);
  for (std::size_t index = 0; index < pairs.size(); ++index)
    anchors.pairs.push_back(json_pair(pairs[index], file + ": pair " + std::to_string(index)));
  const ParsedJson& curves = json_list(document, "curves", file);
  for (std::size_t index = 0; index < curves.size(); ++index)
    anchors.curves.push_back(json_curve(curves[index], file + ": curve " + std::to_string(index)));
  const ParsedJson& patches = json_list(document, "patches", file);
  for (std::size_t index = 0; index < patches.size(); ++index)
    anchors.patches.push_back(json_patch(patches[index], file + ": patch " + std::to_string(index)));
  require_distinct_names(anchors.patches, "patches", file);
  return anchors;
}

}  // namespace bespoke
