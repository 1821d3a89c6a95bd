#include "bespoke/pattern/read_pattern.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "bespoke/error.h"
#include "bespoke/json_reason.h"
#include "bespoke/text_lines.h"

namespace bespoke {
namespace {

using Json = nlohmann::json;

/// The numbers of a list, each one of 0 … limit − 1.
std::vector<int> numbers(const Json& list, Eigen::Index limit, const std::string& what) {
  if (!list.is_array()) throw FormatError(what + " is no list");
  std::vector<int> all;
  for (const Json& number : list) {
    if (!number.is_number_integer() || number < 0 || number >= limit)
      throw FormatError(what + " names " + number.dump() + " of " + std::to_string(limit));
    all.push_back(number.get<int>());
  }
  return all;
}

WrittenPiece piece_of(const Json& json) {
  WrittenPiece piece;
  piece.name = json.at("name").get<std::string>();
  const std::string where = "piece '" + piece.name + "': ";
  const auto vertices = json.at("vertices").get<std::vector<std::array<double, 2>>>();
  const auto shift = json.at("on_sheet").get<std::array<double, 2>>();
  const auto count = static_cast<Eigen::Index>(vertices.size());
  piece.places.setZero(3, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (std::size_t axis = 0; axis < 2; ++axis)
      piece.places(static_cast<Eigen::Index>(axis), i) =
          vertices[static_cast<std::size_t>(i)][axis] + shift[axis];
  const Json& faces = json.at("faces");
  piece.faces.resize(3, static_cast<Eigen::Index>(faces.size()));
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const std::vector<int> corners = numbers(faces[f], count, where + "face " + std::to_string(f));
    if (corners.size() != 3) throw FormatError(where + "face " + std::to_string(f) + " is no triangle");
    piece.faces.col(static_cast<Eigen::Index>(f)) << corners[0], corners[1], corners[2];
  }
  piece.outline = numbers(json.at("outline"), count, where + "its outline");
  piece.product_faces =
      numbers(json.at("product_faces"), std::numeric_limits<int>::max(), where + "\"product_faces\"");
  piece.strain = json.at("strain_of_faces").get<std::vector<double>>();
  if (piece.product_faces.size() != faces.size() || piece.strain.size() != faces.size())
    throw FormatError(where + std::to_string(faces.size()) + " faces, " +
                      std::to_string(piece.product_faces.size()) + " \"product_faces\", " +
                      std::to_string(piece.strain.size()) + " \"strain_of_faces\"");
  return piece;
}

}  // namespace

WrittenPattern read_pattern(const std::filesystem::path& path) {
  const std::string text = read_text_file(path);
  WrittenPattern pattern{path.string(), {}};
  try {
    const Json root = Json::parse(text);
    if (root.at("unit") != "mm") throw FormatError("its unit is not mm");
    for (const Json& piece : root.at("pieces")) pattern.pieces.push_back(piece_of(piece));
  } catch (const Json::exception& error) {
    throw FormatError(path.string() +
                      ": is no pattern as `flatten -o pieces.json` writes it: " + json_reason(error.what()));
  } catch (const FormatError& error) {
    throw FormatError(path.string() + ": " + error.what());
  }
  if (pattern.pieces.empty()) throw FormatError(path.string() + ": it has no pieces");
  return pattern;
}

void require_pattern_of(const WrittenPattern& pattern, const std::string& product, Eigen::Index triangles) {
  std::vector<bool> is_met(static_cast<std::size_t>(triangles));
  bool fits = true;
  for (const WrittenPiece& piece : pattern.pieces)
    for (const int face : piece.product_faces) {
      fits = fits && face >= 0 && face < triangles;
      if (fits) is_met[static_cast<std::size_t>(face)] = true;
    }
  if (!fits || std::find(is_met.begin(), is_met.end(), false) != is_met.end())
    throw InvalidInput(pattern.path + ": its pieces are not the " + std::to_string(triangles) +
                       " triangles of " + product + "; flatten that product, or name the products in the " +
                       "order of their patterns");
}

}  // namespace bespoke
