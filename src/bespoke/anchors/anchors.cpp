#include "bespoke/anchors/anchors.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string_view>
#include <utility>

#include "bespoke/anchors/detail/anchor_json.h"
#include "bespoke/error.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/rigid/rigid_alignment.h"
#include "bespoke/strings.h"

namespace bespoke {
namespace {

std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path))
    throw FileError(path.string() + ": cannot be opened for reading");
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (file.bad()) throw FileError(path.string() + ": reading failed");
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (text.starts_with(byte_order_mark)) text.erase(0, byte_order_mark.size());
  return text;
}

// ---- CSV

/// Fields between commas, without surrounding blanks; a field in double quotes may hold commas and "" for ".
std::vector<std::string> csv_fields(std::string_view row) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (row[i] == '"' && quoted && i + 1 < row.size() && row[i + 1] == '"')
      fields.back() += row[i++];
    else if (row[i] == '"')
      quoted = !quoted;
    else if (row[i] == ',' && !quoted)
      fields.emplace_back();
    else
      fields.back() += row[i];
  }
  for (std::string& field : fields) {
    constexpr const char* blanks = " \t\r";
    field.erase(0, std::min(field.find_first_not_of(blanks), field.size()));
    field.erase(field.find_last_not_of(blanks) + 1);
  }
  return fields;
}

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

double csv_number(const std::string& field, const char* column, const std::string& where) {
  double number = 0;
  const char* end = field.data() + field.size();
  const auto [stop, error] = std::from_chars(field.data(), end, number);
  if (error != std::errc{} || stop != end || !std::isfinite(number))
    throw FormatError(where + ": " + column + " is \"" + field.substr(0, 40) + "\", not a finite number");
  return number;
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

Anchors parse_csv(const std::string& text, const std::string& file) {
  Anchors anchors;
  std::istringstream rows(text);
  std::string row;
  std::vector<std::string> accuracy_columns(csv_accuracy_columns.begin(), csv_accuracy_columns.end());
  bool first = true;
  for (int line = 1; std::getline(rows, row); ++line) {
    const std::vector<std::string> fields = csv_fields(row);
    if (fields.size() == 1 && fields[0].empty()) continue;
    if (std::exchange(first, false) && is_csv_header(fields))
      accuracy_columns.assign(fields.begin() + csv_columns.size(), fields.end());
    else
      anchors.pairs.push_back(csv_pair(fields, accuracy_columns, file + ": line " + std::to_string(line)));
  }
  if (first) throw FormatError(file + ": no rows");
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
  const std::string text = read_text(path);
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
    if (sigma > 0) result[i] = difference * difference / (sigma * sigma);
  }
  return result;
}

std::string label(const Anchors& anchors, std::size_t index) {
  const std::string& name = anchors.pairs[index].name;
  return name.empty() ? "pair " + std::to_string(index + 1) : "\"" + name + "\"";
}

}  // namespace bespoke
