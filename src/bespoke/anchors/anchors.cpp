#include "bespoke/anchors/anchors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "bespoke/anchors/detail/anchor_json.h"
#include "bespoke/anchors/detail/point_text.h"
#include "bespoke/csv_rows.h"
#include "bespoke/error.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/rigid/rigid_alignment.h"
#include "bespoke/strings.h"
#include "bespoke/text_lines.h"

namespace bespoke {
namespace {

constexpr std::array<const char*, 7> csv_columns = {"name", "ax", "ay", "az", "bx", "by", "bz"};
constexpr std::array<const char*, 2> csv_accuracy_columns = {"weight", "sigma"};

bool is_csv_header(const std::vector<std::string>& fields) {
  const auto is_accuracy = [](const std::string& field) {
    return std::find(csv_accuracy_columns.begin(), csv_accuracy_columns.end(), field) !=
           csv_accuracy_columns.end();
  };
  return fields.size() >= csv_columns.size() &&
         fields.size() <= csv_columns.size() + csv_accuracy_columns.size() &&
         std::equal(csv_columns.begin(), csv_columns.end(), fields.begin()) &&
         std::all_of(fields.begin() + csv_columns.size(), fields.end(), is_accuracy) &&
         (fields.size() < csv_columns.size() + 2 || fields[csv_columns.size()] != fields.back());
}

double csv_number(const std::string& cell, const char* column, const std::string& where) {
  const std::string field(csv_characters(cell));
  const std::optional<double> number = decimal_number(field);
  if (!number)
    throw FormatError(where + ": " + column + " is \"" + field.substr(0, 40) + "\", not a finite number");
  return *number;
}

/// accuracy_columns: what stands after the seventh column.
AnchorPair csv_pair(const std::vector<std::string>& fields, const std::vector<std::string>& accuracy_columns,
                    const std::string& where) {
  if (fields.size() < csv_columns.size() || fields.size() > csv_columns.size() + accuracy_columns.size())
    throw FormatError(where + ": " + std::to_string(fields.size()) +
                      " columns, but a row is name,ax,ay,az,bx,by,bz[,weight[,sigma]]");
  AnchorPair pair;
  pair.name = fields[0];
  require_printable(pair.name, where);
  for (int axis = 0; axis < 3; ++axis) {
    const auto column = static_cast<std::size_t>(axis);
    pair.a[axis] = csv_number(fields[1 + column], csv_columns[1 + column], where);
    pair.b[axis] = csv_number(fields[4 + column], csv_columns[4 + column], where);
    require_coordinate(pair.a[axis], where + ": " + csv_columns[1 + column]);
    require_coordinate(pair.b[axis], where + ": " + csv_columns[4 + column]);
  }
  for (std::size_t k = csv_columns.size(); k < fields.size(); ++k) {
    const std::string& column = accuracy_columns[k - csv_columns.size()];
    if (fields[k].empty()) continue;
    const double number = csv_number(fields[k], column.c_str(), where);
    const bool is_weight = column == csv_accuracy_columns.front();
    if (!(is_weight ? number > 0 : number >= 0))
      throw FormatError(where + ": " + column + " is " + fields[k] + ", but must be " +
                        (is_weight ? "> 0" : ">= 0"));
    if (is_weight)
      pair.weight = number;
    else
      pair.sigma = number;
  }
  require_one_accuracy(pair, where);
  return pair;
}

/// Whether the fields are those of the header, or of a row: a name and numbers, which may have decimal
/// commas.
bool is_csv_table(const std::vector<std::string>& fields) {
  if (is_csv_header(fields)) return true;
  constexpr std::string_view of_numbers = "0123456789+-.,eE";
  return fields.size() >= csv_columns.size() &&
         std::all_of(fields.begin() + 1, fields.begin() + csv_columns.size(), [&](const std::string& field) {
           return !field.empty() && field.find_first_not_of(of_numbers) == std::string::npos;
         });
}

/// Turns the decimal commas of a row into points, where the table has them.
void use_points(std::vector<std::string>& fields, const std::string& where) {
  for (auto field = fields.begin() + 1; field != fields.end(); ++field) {
    if (field->find('.') != std::string::npos)
      throw FormatError(where + ": \"" + *field + "\" has a decimal point, but the table has decimal commas");
    if (has_decimal_comma(*field)) (*field)[field->find(',')] = '.';
  }
}

bool has_decimal_commas(const std::vector<std::string_view>& lines, char separator) {
  return separator != ',' && std::any_of(lines.begin(), lines.end(), [&](std::string_view line) {
           const std::vector<std::string> fields = csv_texts(csv_row(line, separator));
           return std::any_of(fields.begin() + 1, fields.end(), has_decimal_comma);
         });
}

Anchors parse_csv(const std::string& text, const std::string& file) {
  Anchors anchors;
  const std::vector<std::string_view> lines = text_lines(text);
  std::vector<std::string> accuracy_columns(csv_accuracy_columns.begin(), csv_accuracy_columns.end());
  std::optional<char> separator;
  bool has_commas = false;
  for (std::size_t line = 0; line < lines.size(); ++line) {
    const std::string where = file + ": line " + std::to_string(line + 1);
    if (lines[line].find_first_not_of(" \t") == std::string_view::npos) continue;
    if (!separator && csv_named_separator(lines[line])) continue;
    const bool is_first = !separator;
    if (is_first) {
      separator = csv_separator(lines[line], is_csv_table).value_or(',');
      has_commas = has_decimal_commas(lines, *separator);
    }
    const CsvRow row = csv_row(lines[line], *separator);
    if (!row.is_closed) throw FormatError(where + ": a quote that does not end in its line");
    std::vector<std::string> fields = csv_texts(row);
    if (is_first && is_csv_header(fields)) {
      accuracy_columns.assign(fields.begin() + csv_columns.size(), fields.end());
      continue;
    }
    if (has_commas) use_points(fields, where);
    anchors.pairs.push_back(csv_pair(fields, accuracy_columns, where));
  }
  if (!separator) throw FormatError(file + ": no rows");
  return anchors;
}

Points points(const Anchors& anchors, Vector3 AnchorPair::*end) {
  Points result(3, static_cast<Eigen::Index>(anchors.pairs.size()));
  for (Eigen::Index i = 0; i < result.cols(); ++i)
    result.col(i) = anchors.pairs[static_cast<std::size_t>(i)].*end;
  return result;
}

}  // namespace

Anchors read_anchors(const std::filesystem::path& path) {
  const std::string text = read_text_file(path);
  if (lower_ending(path) != ".csv") return parse_anchors(text, path.string());
  Anchors anchors = parse_csv(text, path.string());
  require_distinct_names(anchors.pairs, "pairs", path.string());
  return anchors;
}

Anchors parse_anchors(const std::string& text, const std::string& name) {
  Anchors anchors = parse_anchor_json(text, name);
  require_distinct_names(anchors.pairs, "pairs", name);
  return anchors;
}

void add_box_corners(Anchors& anchors, const Points& source_vertices, const Points& target_vertices) {
  if (source_vertices.cols() == 0 || target_vertices.cols() == 0)
    throw InvalidInput("corners of an empty bounding box cannot serve as anchors");
  constexpr std::size_t pairs_that_fix_a_turn = 3;
  RigidTransform target_from_source;
  if (anchors.pairs.size() >= pairs_that_fix_a_turn)
    target_from_source =
        align_rigidly(source_points(anchors), target_points(anchors), spline_weights(anchors));
  const Box source_box = bounding_box(source_vertices);
  const Box target_box = bounding_box(inverse(target_from_source) * target_vertices);
  for (int corner = 0; corner < 8; ++corner) {
    const int bits[3] = {corner >> 2 & 1, corner >> 1 & 1, corner & 1};
    AnchorPair pair;
    pair.sigma = 0;
    pair.name = "corner_";
    for (int axis = 0; axis < 3; ++axis) {
      pair.name += static_cast<char>('0' + bits[axis]);
      pair.a[axis] = bits[axis] ? source_box.max()[axis] : source_box.min()[axis];
      pair.b[axis] = bits[axis] ? target_box.max()[axis] : target_box.min()[axis];
    }
    pair.b = target_from_source * pair.b;
    for (const AnchorPair& present : anchors.pairs)
      if (present.name == pair.name)
        throw InvalidInput("an anchor is already named \"" + pair.name +
                           "\"; rename it, or add no box corners");
    anchors.pairs.push_back(pair);
  }
}

bool is_exact(const AnchorPair& pair) { return std::isinf(pair.weight) && !(pair.sigma.value_or(0) > 0); }

bool has_no_given_sigma(const AnchorPair& pair) { return !pair.sigma && std::isinf(pair.weight); }

Points source_points(const Anchors& anchors) { return points(anchors, &AnchorPair::a); }

Points target_points(const Anchors& anchors) { return points(anchors, &AnchorPair::b); }

Eigen::VectorXd weights(const Anchors& anchors) {
  Eigen::VectorXd result(static_cast<Eigen::Index>(anchors.pairs.size()));
  for (Eigen::Index i = 0; i < result.size(); ++i)
    result[i] = anchors.pairs[static_cast<std::size_t>(i)].weight;
  return result;
}

Eigen::VectorXd sigmas(const Anchors& anchors) {
  Eigen::VectorXd result(static_cast<Eigen::Index>(anchors.pairs.size()));
  for (Eigen::Index i = 0; i < result.size(); ++i)
    result[i] = anchors.pairs[static_cast<std::size_t>(i)].sigma.value_or(0);
  return result;
}

Eigen::VectorXd spline_weights(const Anchors& anchors) {
  constexpr double typical_difference = 0.1;  // of the targets' diagonal
  Eigen::VectorXd result = weights(anchors);
  if (anchors.pairs.empty()) return result;
  const double difference = typical_difference * diagonal(target_points(anchors));
  for (Eigen::Index i = 0; i < result.size(); ++i) {
    const double sigma = anchors.pairs[static_cast<std::size_t>(i)].sigma.value_or(0);
    // Targets at one place weigh nothing against each other, and are refused as such.
    if (sigma > 0 && difference > 0) result[i] = difference * difference / (sigma * sigma);
  }
  return result;
}

std::string label(const Anchors& anchors, std::size_t index) {
  const std::string& name = anchors.pairs[index].name;
  return name.empty() ? "pair " + std::to_string(index + 1) : "\"" + name + "\"";
}

}  // namespace bespoke
