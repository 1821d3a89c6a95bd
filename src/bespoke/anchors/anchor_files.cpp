#include "bespoke/anchors/anchor_files.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string_view>

#include "bespoke/anchors/detail/paired_sides.h"
#include "bespoke/anchors/detail/point_files.h"
#include "bespoke/atomic_file.h"
#include "bespoke/error.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/strings.h"
#include "bespoke/text_lines.h"
#include "bespoke/unknown_ending.h"

namespace bespoke {
namespace {

using Json = nlohmann::ordered_json;

/// XML says itself how it is encoded.
std::string file_text(const std::filesystem::path& path) {
  if (anchor_format_of(path) != AnchorFormat::meshlab) return read_text_file(path);
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path))
    throw FileError(path.string() + ": cannot be opened for reading");
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  write_atomically(path, [&](const std::filesystem::path& temporary) {
    std::ofstream file(temporary, std::ios::binary);
    file << text;
    file.close();
    if (!file) throw FileError(path.string() + ": cannot be written");
  });
}

void require_files(const std::vector<std::filesystem::path>& paths, AnchorFormat format) {
  const std::size_t wanted = has_file_per_side(format) ? 2 : 1;
  if (paths.size() != wanted)
    throw InvalidInput(
        paths.front().string() + ": the format " + std::string(name_of(anchor_formats, format)) +
        (wanted == 2 ? " has one file a side: give two" : " has both sides in one file: give one"));
  for (const std::filesystem::path& path : paths)
    if (anchor_format_of(path) != format)
      throw InvalidInput(path.string() + ": is of another format than " + paths.front().string());
}

bool needs_models(AnchorFormat format) {
  return format == AnchorFormat::wrap || format == AnchorFormat::indices;
}

void require_models(AnchorFormat format, const AnchorFileOptions& options) {
  if (needs_models(format) && (options.source == nullptr || options.target == nullptr))
    throw InvalidInput(std::string("the format ") + std::string(name_of(anchor_formats, format)) +
                       " names places of the models: give both");
}

// ---- vertex numbers

Anchors parse_indices(const std::string& text, const std::string& file, const AnchorFileOptions& options) {
  const std::vector<std::string_view> lines = text_lines(text);
  Anchors anchors;
  for (std::size_t line = 0; line < lines.size(); ++line) {
    const std::string where = file + ":" + std::to_string(line + 1);
    std::string row(lines[line]);
    std::replace_if(
        row.begin(), row.end(), [](char c) { return c == ',' || c == ';'; }, ' ');
    std::istringstream words(row);
    long a = 0, b = 0;
    std::string rest;
    if (row.find_first_not_of(" \t\r") == std::string::npos || row[0] == '#') continue;
    if (!(words >> a >> b) || words >> rest) throw FormatError(where + ": a line is two vertex numbers");
    for (const auto& [number, mesh, side] :
         {std::tuple{a, options.source, "source"}, {b, options.target, "target"}})
      if (number < 0 || number >= mesh->vertices.cols())
        throw FormatError(where + ": vertex " + std::to_string(number) + " of the " + side + "'s " +
                          std::to_string(mesh->vertices.cols()));
    anchors.pairs.push_back({"", options.source->vertices.col(a), options.target->vertices.col(b)});
  }
  return anchors;
}

Eigen::Index nearest_vertex(const TriangleMesh& mesh, const Vector3& x) {
  Eigen::Index nearest = 0;
  (mesh.vertices.colwise() - x).colwise().squaredNorm().minCoeff(&nearest);
  return nearest;
}

std::string indices_text(const Anchors& anchors, const AnchorFileOptions& options) {
  std::string text;
  for (const AnchorPair& pair : anchors.pairs)
    text += std::to_string(nearest_vertex(*options.source, pair.a)) + " " +
            std::to_string(nearest_vertex(*options.target, pair.b)) + "\n";
  return text;
}

// ---- this project's own

Json polyline_json(const Points& points) {
  Json json = Json::array();
  for (const auto& point : points.colwise()) json.push_back({point.x(), point.y(), point.z()});
  return json;
}

Json curve_json(const AnchorCurve& curve) {
  Json json = Json::object();
  if (!curve.name.empty()) json["name"] = curve.name;
  json["a"] = polyline_json(curve.a);
  json["b"] = polyline_json(curve.b);
  if (curve.closed) json["closed"] = true;
  if (!curve.fixed.empty()) json["fixed"] = curve.fixed;
  return json;
}

Json side_json(const PatchSide& side) {
  if (!side.faces.empty()) return {{"faces", side.faces}};
  return {{"border", polyline_json(side.border)}};
}

Json patch_json(const AnchorPatch& patch) {
  Json json = Json::object();
  if (!patch.name.empty()) json["name"] = patch.name;
  if (!patch.a.is_empty()) json["a"] = side_json(patch.a);
  if (!patch.b.is_empty()) json["b"] = side_json(patch.b);
  if (patch.exclude) json["exclude"] = true;
  return json;
}

std::string csv_text(const Anchors& anchors) {
  std::ostringstream text;
  text.precision(17);
  text << "name,ax,ay,az,bx,by,bz,weight,sigma\n";
  for (const AnchorPair& pair : anchors.pairs) {
    text << '"';
    for (const char letter : pair.name) text << (letter == '"' ? "\"\"" : std::string(1, letter));
    text << '"';
    for (const Vector3& x : {pair.a, pair.b}) text << ',' << x.x() << ',' << x.y() << ',' << x.z();
    text << ',';
    if (std::isfinite(pair.weight)) text << pair.weight;
    text << ',';
    if (pair.sigma) text << *pair.sigma;
    text << '\n';
  }
  return text.str();
}

FileSide side_of(const Anchors& anchors, Vector3 AnchorPair::*end, Points AnchorCurve::*line) {
  FileSide side;
  for (const AnchorPair& pair : anchors.pairs) side.points.push_back({pair.name, pair.*end});
  for (const AnchorCurve& curve : anchors.curves)
    side.lines.push_back({curve.name, curve.*line, curve.closed});
  return side;
}

// ---- what has no place

template <typename Each, typename Has>
std::string counted_with(const std::vector<Each>& list, const char* one, const char* more, Has has) {
  const auto count = std::count_if(list.begin(), list.end(), has);
  return count == 0 ? "" : std::to_string(count) + " " + (count == 1 ? one : more);
}

// ---- a file of one side

/// How the names of such files end.
std::string_view side_ending(AnchorFormat format) {
  switch (format) {
    case AnchorFormat::meshlab:
      return ".pp";
    case AnchorFormat::markups:
      return ".mrk.json";
    case AnchorFormat::fiducials:
      return ".fcsv";
    case AnchorFormat::landmarks:
      return ".pts";
    default:
      return ".json";
  }
}

/// Wrap's lists, whose files often end in .json alone; our own JSON is an object.
bool is_list_of_lists(const std::filesystem::path& path) {
  std::ifstream file(path);
  char first = 0, second = 0;
  return file >> first >> second && first == '[' && second == '[';
}

/// As a shell takes it.
std::string quoted(const std::filesystem::path& path) {
  const std::string name = path.string();
  constexpr const char* plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_./+,:=@%";
  if (name.find_first_not_of(plain) == std::string::npos) return name;
  std::string text = "'";
  for (const char letter : name) text += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
  return text + "'";
}

/// The only other file of this format in the directory; none where there are several.
std::optional<std::filesystem::path> other_side(const std::filesystem::path& path, AnchorFormat format) {
  namespace fs = std::filesystem;
  std::error_code error;
  std::vector<fs::path> others;
  const fs::path directory = path.has_parent_path() ? path.parent_path() : ".";
  for (const fs::directory_entry& entry : fs::directory_iterator(directory, error)) {
    const fs::path other = path.parent_path() / entry.path().filename();
    if (other == path || !entry.is_regular_file(error)) continue;
    const std::string name = lower_case(other.filename().string());
    const bool is_named_so = name.ends_with(side_ending(format));
    if (is_named_so && anchor_format_of(other) == format) others.push_back(other);
  }
  return others.size() == 1 ? std::optional(others.front()) : std::nullopt;
}

[[noreturn]] void refuse_one_side(const std::filesystem::path& path, AnchorFormat format) {
  const std::filesystem::path other =
      other_side(path, format).value_or(path.parent_path() / ("OTHER" + std::string(side_ending(format))));
  std::string line = "bespoke anchors convert " + quoted(path) + " " + quoted(other);
  if (needs_models(format)) line += " --source SOURCE --target TARGET";
  throw InvalidInput(path.string() + ": has the points of one model only, as the format " +
                     std::string(name_of(anchor_formats, format)) +
                     " does; join it with the file of the other model, the source's first: " + line + " -o " +
                     quoted(path.parent_path() / "anchors.json") + "; then give that file");
}

std::string of(const char* what, const std::string& owners) { return owners.empty() ? "" : what + owners; }

}  // namespace

AnchorFormat anchor_format_of(const std::filesystem::path& path) {
  const std::string name = lower_case(path.filename().string());
  if (name.ends_with(".mrk.json")) return AnchorFormat::markups;
  if (name.ends_with(".wrap.json")) return AnchorFormat::wrap;
  if (name.ends_with(".csv")) return AnchorFormat::csv;
  if (name.ends_with(".pp")) return AnchorFormat::meshlab;
  if (name.ends_with(".fcsv")) return AnchorFormat::fiducials;
  if (name.ends_with(".pts")) return AnchorFormat::landmarks;
  if (name.ends_with(".txt")) return AnchorFormat::indices;
  if (!name.ends_with(".json"))
    throw UnknownEnding(
        path.string() +
        ": unknown ending; known are .json, .csv, .pp, .mrk.json, .fcsv, .pts, .wrap.json and .txt");
  // Wrap's files have no ending of their own; they are arrays.
  std::ifstream file(path, std::ios::binary);
  std::string head(64, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  const std::string_view text = without_byte_order_mark(head);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && text[first] == '[' ? AnchorFormat::wrap : AnchorFormat::json;
}

bool has_file_per_side(AnchorFormat format) {
  return format != AnchorFormat::json && format != AnchorFormat::csv && format != AnchorFormat::indices;
}

Anchors read_anchor_files(const std::vector<std::filesystem::path>& paths, const AnchorFileOptions& options) {
  const AnchorFormat format = anchor_format_of(paths.at(0));
  require_files(paths, format);
  require_models(format, options);
  if (format == AnchorFormat::json || format == AnchorFormat::csv) return read_anchors(paths[0]);
  if (format == AnchorFormat::indices) return parse_indices(file_text(paths[0]), paths[0].string(), options);
  return paired(parse_side(file_text(paths[0]), format, paths[0].string(), options.source, options.models),
                parse_side(file_text(paths[1]), format, paths[1].string(), options.target, options.models),
                paths);
}

Anchors read_anchor_file(const std::filesystem::path& path, const AnchorFileOptions& options) {
  // What is no file can be read only once, so its format cannot be looked at first.
  const bool is_there = std::filesystem::exists(path);
  if (!path.has_extension() || (is_there && !std::filesystem::is_regular_file(path)))
    return read_anchors(path);
  const AnchorFormat format = anchor_format_of(path);
  const bool is_wrap = lower_case(path.filename().string()).ends_with(".wrap.json");
  if (format == AnchorFormat::wrap && !is_wrap && !is_list_of_lists(path)) return read_anchors(path);
  if (!has_file_per_side(format)) return read_anchor_files({path}, options);
  refuse_one_side(path, format);
}

bool has_curves(AnchorFormat format) {
  return format == AnchorFormat::json || format == AnchorFormat::markups;
}

std::string left_out(const Anchors& anchors, AnchorFormat format) {
  if (format == AnchorFormat::json) return "";
  const bool has_names = format != AnchorFormat::wrap && format != AnchorFormat::indices;
  const auto pairs_with = [&](auto has) { return counted_with(anchors.pairs, "pair", "pairs", has); };
  const auto curves_with = [&](auto has) { return counted_with(anchors.curves, "curve", "curves", has); };
  const auto any = [](const auto&) { return true; };
  std::vector<std::string> parts;
  if (!anchors.unit.empty()) parts.push_back("the unit (" + anchors.unit + ")");
  if (!has_names)
    parts.push_back(
        of("the names of ", pairs_with([](const AnchorPair& pair) { return !pair.name.empty(); })));
  if (format != AnchorFormat::csv)
    parts.push_back(of("the accuracies of ", pairs_with([](const AnchorPair& pair) {
                         return pair.sigma || std::isfinite(pair.weight);
                       })));
  if (has_curves(format))
    parts.push_back(of("the fixed points of ",
                       curves_with([](const AnchorCurve& curve) { return !curve.fixed.empty(); })));
  else
    parts.push_back(curves_with(any));
  parts.push_back(counted_with(anchors.patches, "patch", "patches", any));
  std::string text;
  for (const std::string& part : parts)
    if (!part.empty()) text += (text.empty() ? "" : ", ") + part;
  return text;
}

std::string anchors_json(const Anchors& anchors) {
  Json pairs = Json::array();
  for (const AnchorPair& pair : anchors.pairs) {
    Json json = Json::object();
    if (!pair.name.empty()) json["name"] = pair.name;
    json["a"] = {pair.a.x(), pair.a.y(), pair.a.z()};
    json["b"] = {pair.b.x(), pair.b.y(), pair.b.z()};
    if (std::isfinite(pair.weight)) json["weight"] = pair.weight;
    if (pair.sigma) json["sigma"] = *pair.sigma;
    pairs.push_back(std::move(json));
  }
  Json document = Json::object();
  if (!anchors.unit.empty()) document["units"] = anchors.unit;
  document["pairs"] = std::move(pairs);
  for (const AnchorCurve& curve : anchors.curves) document["curves"].push_back(curve_json(curve));
  for (const AnchorPatch& patch : anchors.patches) document["patches"].push_back(patch_json(patch));
  return document.dump(1) + "\n";
}

void write_anchor_files(const std::vector<std::filesystem::path>& paths, const Anchors& anchors,
                        const AnchorFileOptions& options) {
  const AnchorFormat format = anchor_format_of(paths.at(0));
  require_files(paths, format);
  require_models(format, options);
  if (format == AnchorFormat::json) return write_text(paths[0], anchors_json(anchors));
  if (format == AnchorFormat::csv) return write_text(paths[0], csv_text(anchors));
  if (format == AnchorFormat::indices) return write_text(paths[0], indices_text(anchors, options));
  const FileSide a = side_of(anchors, &AnchorPair::a, &AnchorCurve::a);
  const FileSide b = side_of(anchors, &AnchorPair::b, &AnchorCurve::b);
  write_text(paths[0], side_text(a, format, options.source, options.models));
  write_text(paths[1], side_text(b, format, options.target, options.models));
}

}  // namespace bespoke
