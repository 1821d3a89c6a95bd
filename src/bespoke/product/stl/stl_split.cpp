#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/product/carry/product_formats.h"
#include "bespoke/product/faces/face_parts.h"
#include "bespoke/product/faces/gathered_faces.h"
#include "bespoke/product/stl/stl_file.h"
#include "bespoke/product/text/split_numbers.h"
#include "bespoke/strings.h"
#include "bespoke/text_lines.h"

namespace bespoke {
namespace {

/// Facets that read_product leaves out, since corners coincide, are no polygons, and stay as they are.
std::vector<bool> are_polygons(const Points& corners) {
  std::vector<bool> result(static_cast<std::size_t>(corners.cols() / 3));
  for (const std::size_t facet : kept_triangles(corners)) result[facet] = true;
  return result;
}

std::size_t count_of(const std::vector<bool>& polygons) {
  return static_cast<std::size_t>(std::count(polygons.begin(), polygons.end(), true));
}

std::string split_binary_stl(const InputFile& file, std::size_t facets, const FaceSplits& splits) {
  const std::string content = file.content();
  const std::string_view body = std::string_view(content).substr(stl_header_size);
  const Points stored = facet_points({body, 0}, file, facets);
  Points corners(3, stored.cols() / 4 * 3);
  for (Eigen::Index i = 0; i < stored.cols() / 4; ++i)
    corners.middleCols<3>(3 * i) = stored.middleCols<3>(4 * i + 1);
  const std::vector<bool> polygons = are_polygons(corners);
  const FaceParts parts(splits, count_of(polygons), file.path());
  const auto middle = [](const Vector3& a, const Vector3& b, int) -> Vector3 { return 0.5 * (a + b); };

  std::string result = content.substr(0, stl_header_size);
  std::size_t polygon = 0;
  for (std::size_t i = 0; i < facets; ++i) {
    const std::string_view facet = body.substr(i * stl_facet_size, stl_facet_size);
    if (!polygons[i] || !parts.is_split(polygon++)) {
      result += facet;
      continue;
    }
    const auto first = static_cast<Eigen::Index>(3 * i);
    const std::vector<Vector3> own{corners.col(first), corners.col(first + 1), corners.col(first + 2)};
    for (const std::vector<Vector3>& part : parts.parts(polygon - 1, own, middle)) {
      Eigen::Matrix3f now;
      for (std::size_t k = 0; k < 3; ++k) now.col(static_cast<Eigen::Index>(k)) = part[k].cast<float>();
      result += facet;
      std::memcpy(result.data() + result.size() - stl_facet_size + stl_normal_size, now.data(), sizeof now);
    }
  }
  const std::size_t count = (result.size() - stl_header_size) / stl_facet_size;
  if (count > std::numeric_limits<std::uint32_t>::max())
    throw InvalidInput(file.path().string() + ": would have " + std::to_string(count) +
                       " facets, more than a binary STL file can count");
  const auto stored_count = static_cast<std::uint32_t>(count);
  std::memcpy(result.data() + stl_header_size - sizeof stored_count, &stored_count, sizeof stored_count);
  return result;
}

/// From "facet" to "endfacet".
std::vector<std::string_view> facet_texts(const TextBlock& block, const std::filesystem::path& path) {
  std::vector<std::string_view> facets;
  const char* begin = nullptr;
  TextWords words(block, path, {0, false});
  while (words.next_line()) {
    const std::string keyword = lower_case(words.word());
    if (keyword == "facet") begin = words.line_begin();
    if (keyword == "endfacet") facets.emplace_back(begin, words.line_begin() + keyword.size() - begin);
  }
  return facets;
}

/// The three numbers of a corner, with the blanks between them.
std::string_view text_of(const NumberTriple& triple) {
  return {triple[0].begin, static_cast<std::size_t>(triple[2].begin + triple[2].length - triple[0].begin)};
}

struct TextCorner {
  Vector3 place;
  std::string text;
};

std::string split_text_stl(const InputFile& file, const FaceSplits& splits) {
  const std::string content = file.content();
  TextBlock block;
  block.bytes = content;
  const std::vector<NumberTriple> corners = StlText(file.path(), false).records(block).points;
  const std::vector<std::string_view> facets = facet_texts(block, file.path());
  const Points places = values(corners);
  const int decimals = position_decimals(corners);
  const std::string_view line_break = first_line_break(content);
  const std::vector<bool> polygons = are_polygons(places);
  const FaceParts parts(splits, count_of(polygons), file.path());
  const auto middle = [&](const TextCorner& a, const TextCorner& b, int) {
    TextCorner corner{0.5 * (a.place + b.place), {}};
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      if (axis > 0) corner.text += ' ';
      append_number(corner.text, corner.place[axis], decimals);
    }
    return corner;
  };

  std::vector<TextEdit> edits;
  std::size_t polygon = 0;
  for (std::size_t i = 0; i < facets.size(); ++i) {
    if (!polygons[i] || !parts.is_split(polygon++)) continue;
    std::vector<TextCorner> own;
    for (std::size_t k = 3 * i; k < 3 * i + 3; ++k)
      own.push_back({places.col(static_cast<Eigen::Index>(k)), std::string(text_of(corners[k]))});
    const std::size_t begin = static_cast<std::size_t>(facets[i].data() - content.data());
    const std::size_t line = content.find_last_of("\r\n", begin) + 1;  // 0 where there is none
    std::string text;
    for (const std::vector<TextCorner>& part : parts.parts(polygon - 1, own, middle)) {
      if (!text.empty()) text.append(line_break).append(content, line, begin - line);
      std::vector<TextEdit> of_part;
      for (std::size_t k = 0; k < 3; ++k) of_part.push_back({text_of(corners[3 * i + k]), part[k].text});
      text += edited(facets[i], {}, std::move(of_part));
    }
    edits.push_back({facets[i], std::move(text)});
  }
  return edited(content, {}, std::move(edits));
}

}  // namespace

void split_stl(const InputFile& file, const FaceSplits& splits, OutputFile& output) {
  const std::optional<std::size_t> facets = binary_stl_facets(file);
  output.write(facets ? split_binary_stl(file, *facets, splits) : split_text_stl(file, splits));
}

}  // namespace bespoke
