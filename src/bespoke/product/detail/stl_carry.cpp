#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "bespoke/error.h"
#include "bespoke/product/detail/directions.h"
#include "bespoke/product/detail/product_formats.h"
#include "bespoke/product/detail/text_records.h"

namespace bespoke {
namespace {

constexpr std::size_t header_size = 84, facet_size = 50, normal_size = 12;
constexpr std::size_t facets_a_block = std::size_t{1} << 14;

std::string lower(std::string_view word) {
  std::string result(word);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

/// The first word of a line, in lower case.
std::string first_word(std::string_view line) {
  const std::size_t begin = std::min(line.find_first_not_of(" \t\r"), line.size());
  return lower(line.substr(begin, line.find_first_of(" \t\r\n", begin) - begin));
}

/// How many solids begin and end.
void count_solids(std::string_view lines, std::array<std::uint64_t, 3>& sums) {
  TextBlock block;
  block.bytes = lines;
  const std::filesystem::path unnamed;
  TextWords words(block, unnamed, {0, false});
  while (words.next_line()) {
    if (std::string_view("sSeE").find(*words.line_begin()) == std::string_view::npos) continue;
    const std::string keyword = lower(words.word());
    sums[0] += keyword == "solid";
    sums[1] += keyword == "endsolid";
  }
}

/// Text; blocks end where facets do. A facet's normal moves as at the middle of its corners.
class StlText : public TextFormat {
 public:
  explicit StlText(const std::filesystem::path& path) : path_(path) {}

  TextCutter cutter() const override {
    return {path_, 1, count_solids, [](std::string_view line) { return first_word(line) == "endfacet"; }};
  }

  TextRecords records(const TextBlock& block) const override {
    TextRecords records;
    TextWords words(block, path_, {0, false});
    bool is_inside = block.before[0] > block.before[1];
    while (words.next_line()) {
      const std::string keyword = lower(words.word());
      if (keyword == "solid" && !is_inside) {
        is_inside = true;
      } else if (keyword == "endsolid" && is_inside) {
        is_inside = false;
      } else if (keyword == "facet" && is_inside) {
        read_facet(words, records);
      } else {
        words.fail("the word " + in_quotes(keyword) + " in a wrong place");
      }
    }
    return records;
  }

  void require_complete(const std::array<std::uint64_t, 3>& sums) const override {
    if (sums[0] != sums[1]) throw FormatError(path_.string() + ": the file ends before endsolid");
  }

 private:
  static void expect(TextWords& words, const char* keyword, bool on_new_line = true) {
    if (on_new_line && !words.next_line())
      words.fail(std::string("the file ends before the facet's ") + keyword);
    const std::string_view word = words.word();
    if (lower(word) != keyword) words.fail(in_quotes(word) + " where " + keyword + " must stand");
  }

  static void read_facet(TextWords& words, TextRecords& records) {
    expect(words, "normal", false);
    records.normals.push_back({words.number("nx"), words.number("ny"), words.number("nz")});
    expect(words, "outer");
    expect(words, "loop", false);
    for (int corner = 0; corner < 3; ++corner) {
      expect(words, "vertex");
      records.points.push_back({words.number("x"), words.number("y"), words.number("z")});
    }
    expect(words, "endloop");
    expect(words, "endfacet");
  }

  const std::filesystem::path& path_;
};

/// Whole facets.
struct FacetBlock {
  std::string_view bytes;
  std::size_t first = 0;
};

class StlBinary {
 public:
  StlBinary(const InputFile& file, std::size_t facets, const PointMotion& motion)
      : file_(file), facets_(facets), motion_(motion) {}

  std::vector<FacetBlock> cut(const Window& window) {
    std::vector<FacetBlock> blocks;
    std::string_view rest = window.bytes;
    while (rest.size() >= facet_size) {
      const std::size_t count = std::min(rest.size() / facet_size, facets_a_block);
      blocks.push_back({rest.substr(0, count * facet_size), done_});
      rest.remove_prefix(count * facet_size);
      done_ += count;
    }
    return blocks;
  }

  std::vector<std::string> carry(const FacetBlock& block) const {
    const auto facets = static_cast<Eigen::Index>(block.bytes.size() / facet_size);
    Points corners(3, 3 * facets), normals(3, facets), centers(3, facets);
    for (Eigen::Index i = 0; i < facets; ++i) {
      Eigen::Matrix<float, 3, 4> stored;
      std::memcpy(stored.data(), block.bytes.data() + static_cast<std::size_t>(i) * facet_size,
                  sizeof(float) * 12);
      if (!stored.rightCols<3>().allFinite())
        throw FormatError(file_.path().string() + ": facet " +
                          std::to_string(block.first + static_cast<std::size_t>(i)) + " of " +
                          std::to_string(facets_) + " has a coordinate that is not finite");
      normals.col(i) = stored.col(0).cast<double>();
      corners.middleCols<3>(3 * i) = stored.rightCols<3>().cast<double>();
      centers.col(i) = corners.middleCols<3>(3 * i).rowwise().mean();
    }
    const std::vector<Points> images = motion_.images(corners);
    const std::vector<Points> jacobians = motion_.jacobians(centers);
    std::vector<std::string> frames(motion_.frames, std::string(block.bytes));
    for (std::size_t frame = 0; frame < motion_.frames; ++frame)
      write(images[frame], moved_normals(normals, jacobians[frame]), frames[frame]);
    return frames;
  }

 private:
  void write(const Points& corners, const Points& normals, std::string& bytes) const {
    if (!(corners.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <=
          static_cast<double>(std::numeric_limits<float>::max())))
      throw InvalidInput(file_.path().string() +
                         ": a point goes to a place that the file's numbers cannot hold");
    for (Eigen::Index i = 0; i < normals.cols(); ++i) {
      char* const facet = bytes.data() + static_cast<std::size_t>(i) * facet_size;
      const Eigen::Vector3f normal = normals.col(i).cast<float>();
      const Eigen::Matrix3f corner = corners.middleCols<3>(3 * i).cast<float>();
      // A normal that is no number keeps its bytes.
      if (normal.allFinite()) std::memcpy(facet, normal.data(), normal_size);
      std::memcpy(facet + normal_size, corner.data(), sizeof(float) * 9);
    }
  }

  const InputFile& file_;
  std::size_t facets_;
  const PointMotion& motion_;
  std::size_t done_ = 0;
};

CarrySummary carry_binary(const InputFile& file, std::vector<OutputFile>& outputs, std::size_t facets,
                          const PointMotion& motion, const Progress& progress) {
  if (facets == 0) throw FormatError(file.path().string() + ": the file has no facets");
  std::string head(header_size, '\0');
  file.read(0, head.data(), head.size());
  for (OutputFile& output : outputs) output.write(head);
  StlBinary stl(file, facets, motion);
  walk_blocks(
      file, header_size, [&](const Window& window) { return stl.cut(window); },
      [&](const FacetBlock& block) { return stl.carry(block); },
      [&](const FacetBlock&, std::vector<std::string>&& frames) {
        for (std::size_t frame = 0; frame < outputs.size(); ++frame) outputs[frame].write(frames[frame]);
      },
      progress);
  return {3 * facets, facets, {}, {}, {}};
}

}  // namespace

// Binary files that begin with "solid" exist, so the size decides.
CarrySummary carry_stl(const InputFile& file, std::vector<OutputFile>& outputs, const PointMotion& motion,
                       const Progress& progress) {
  const std::string head = file_head(file);
  std::uint32_t facets = 0;
  if (head.size() >= header_size) std::memcpy(&facets, head.data() + 80, sizeof facets);
  const std::uint64_t binary_size = header_size + std::uint64_t{facets} * facet_size;
  if (file.size() == binary_size) return carry_binary(file, outputs, facets, motion, progress);
  if (first_word(head.substr(0, head.find('\n'))) == "solid")
    return carry_text(file, outputs, StlText(file.path()), motion, progress);
  if (head.size() < header_size)
    throw FormatError(file.path().string() +
                      ": neither text that begins with \"solid\" nor as long as a binary STL file's header");
  throw FormatError(file.path().string() + ": a binary STL file of " + std::to_string(facets) +
                    " facets has " + std::to_string(binary_size) + " bytes, this one has " +
                    std::to_string(file.size()));
}

}  // namespace bespoke
