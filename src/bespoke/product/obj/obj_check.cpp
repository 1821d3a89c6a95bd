#include "bespoke/product/obj/obj_check.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <string_view>

#include "bespoke/error.h"
#include "bespoke/product/faces/gathered_faces.h"
#include "bespoke/product/obj/obj_statements.h"
#include "bespoke/product/text/text_records.h"

namespace bespoke {
namespace {

using Counts = std::array<long long, 3>;
using Uses = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

constexpr std::array<const char*, 3> kind_names{"vertex", "texture coordinate", "normal"};

struct BlockFindings {
  Box box;
  CarriedDecimals position_decimals, normal_decimals;
  Counts largest{};  ///< numbers that elements name
  Uses uses;
  bool has_free_form = false;
  DegenerateFaces degenerate;
};

class BlockCheck {
 public:
  BlockCheck(const TextBlock& block, const std::filesystem::path& path, const Counts& limits)
      : words_(block, path, obj_syntax), limits_(limits) {
    for (std::size_t kind = 0; kind < 3; ++kind) count_[kind] = static_cast<long long>(block.before[kind]);
  }

  BlockFindings run() {
    while (words_.next_line()) {
      const std::string_view keyword = words_.word();
      switch (obj_statement(keyword)) {
        case ObjStatement::position:
          read_position();
          break;
        case ObjStatement::normal:
          for (const NumberText& number : read_triple(words_)) findings_.normal_decimals.add(number);
          ++count_[2];
          break;
        case ObjStatement::texture:
          words_.number("texture coordinate");
          ++count_[1];
          break;
        case ObjStatement::face:
          read_element("face", 3);
          break;
        case ObjStatement::line:
          read_element("line", 2);
          break;
        case ObjStatement::point:
          read_element("point", 1);
          break;
        case ObjStatement::free_form:
          findings_.has_free_form = true;
          break;
        case ObjStatement::other:
          break;
      }
    }
    return std::move(findings_);
  }

 private:
  void read_position() {
    const NumberTriple position = read_triple(words_);
    for (const NumberText& number : position) findings_.position_decimals.add(number);
    findings_.box.extend(Vector3(position[0].value, position[1].value, position[2].value));
    ++count_[0];
  }

  void read_element(const char* what, std::size_t least) {
    std::size_t corners = 0;
    int form = 0;
    vertices_.clear();
    for (std::string_view word = words_.word(); !word.empty(); word = words_.word(), ++corners) {
      const std::optional<ObjCorner> corner = read_corner(word);
      if (!corner) words_.fail(std::string("a ") + what + " has the corner " + in_quotes(word));
      const int own = (corner->index[1] != 0) + 2 * (corner->index[2] != 0);
      if (corners > 0 && own != form)
        words_.fail(std::string("the corners of a ") + what + " differ in form");
      form = own;
      Counts index{};
      for (std::size_t kind = 0; kind < 3; ++kind)
        if (corner->index[kind] != 0) index[kind] = resolved(what, kind, corner->index[kind]);
      if (index[2] > 0) add_use(index[2] - 1, index[0] - 1);
      vertices_.push_back(index[0]);
    }
    if (corners < least)
      words_.fail(std::string("a ") + what + " of " + std::to_string(corners) + " corners");
    if (least < 3) return;
    std::sort(vertices_.begin(), vertices_.end());
    const auto twice = std::adjacent_find(vertices_.begin(), vertices_.end());
    if (twice != vertices_.end())
      add(findings_.degenerate,
          [&] { return words_.place() + ": a face names vertex " + std::to_string(*twice) + " twice"; });
  }

  // Elements may name what comes later in the file, so an upper limit is known only once the file is read.
  long long resolved(const char* what, std::size_t kind, long long written) {
    const long long index = written < 0 ? count_[kind] + 1 + written : written;
    if (index < 1 || index > limits_[kind])
      words_.fail(std::string("a ") + what + " names " + kind_names[kind] + " " + std::to_string(written) +
                  " of " + std::to_string(written < 0 ? count_[kind] : limits_[kind]));
    findings_.largest[kind] = std::max(findings_.largest[kind], index);
    return index;
  }

  void add_use(long long normal, long long position) {
    const std::pair use(static_cast<std::uint32_t>(normal), static_cast<std::uint32_t>(position));
    if (findings_.uses.empty() || findings_.uses.back() != use) findings_.uses.push_back(use);
  }

  TextWords words_;
  Counts limits_;
  Counts count_{};
  std::vector<long long> vertices_;  // of an element
  BlockFindings findings_;
};

void sort_unique(Uses& uses) {
  std::sort(uses.begin(), uses.end());
  uses.erase(std::unique(uses.begin(), uses.end()), uses.end());
}

/// Gathers the uses of normals, most of which repeat earlier ones.
class UseTable {
 public:
  /// A number that no file of so many bytes can have a normal for takes no memory: it is refused at the end.
  explicit UseTable(std::uint64_t bytes) : max_normals_(bytes / std::string_view("vn 0 0 0").size()) {}

  void add(const Uses& uses, ObjContent& content) {
    for (const auto& [normal, position] : uses) {
      if (normal >= max_normals_) continue;
      if (normal >= content.first_use.size()) content.first_use.resize(normal + 1, ObjContent::unused);
      std::uint32_t& first = content.first_use[normal];
      if (first == ObjContent::unused)
        first = position;
      else if (first != position)
        content.more_uses.emplace_back(normal, position);
    }
    if (content.more_uses.size() < 2 * unique_ + (std::size_t{1} << 20)) return;
    sort_unique(content.more_uses);
    unique_ = content.more_uses.size();
  }

 private:
  std::uint64_t max_normals_;
  std::size_t unique_ = 0;
};

void finish_uses(ObjContent& content) {
  sort_unique(content.more_uses);
  const std::uint64_t normals = content.counts[2];
  if (normals == 0) return;
  if (content.first_use.empty() && normals == content.counts[0])
    for (std::uint64_t i = 0; i < normals; ++i) content.first_use.push_back(static_cast<std::uint32_t>(i));
  content.first_use.resize(normals, ObjContent::unused);
  content.unused_normals = static_cast<std::size_t>(
      std::count(content.first_use.begin(), content.first_use.end(), ObjContent::unused));
}

}  // namespace

ObjContent check_obj_product(const InputFile& file, const Progress& progress) {
  text_head(file);
  ObjContent content;
  UseTable uses(file.size());
  Counts largest{};
  Counts limits;
  limits.fill(ObjContent::unused - 1);
  TextCutter cutter(file.path(), 1, count_obj);
  walk_blocks(
      {file, 0}, [&](const Window& window) { return cutter(window); },
      [&](const TextBlock& block) { return BlockCheck(block, file.path(), limits).run(); },
      [&](const TextBlock&, BlockFindings&& found) {
        content.box.extend(found.box);
        content.position_decimals.merge(found.position_decimals);
        content.normal_decimals.merge(found.normal_decimals);
        content.has_free_form = content.has_free_form || found.has_free_form;
        if (content.degenerate.count == 0) content.degenerate.first = found.degenerate.first;
        content.degenerate.count += found.degenerate.count;
        for (std::size_t kind = 0; kind < 3; ++kind)
          largest[kind] = std::max(largest[kind], found.largest[kind]);
        uses.add(found.uses, content);
      },
      progress);
  content.counts = cutter.sums();
  bool is_complete = true;
  for (std::size_t kind = 0; kind < 3; ++kind) {
    limits[kind] = static_cast<long long>(content.counts[kind]);
    is_complete = is_complete && largest[kind] <= limits[kind];
  }
  if (!is_complete) {
    // Once more, to name the first line that requires too much.
    TextCutter again(file.path(), 1, count_obj);
    walk_blocks(
        {file, 0}, [&](const Window& window) { return again(window); },
        [&](const TextBlock& block) { return BlockCheck(block, file.path(), limits).run(); },
        [](const TextBlock&, BlockFindings&&) {}, progress);
  }
  if (content.counts[0] == 0) throw FormatError(file.path().string() + ": the file has no vertices");
  if (content.counts[0] >= ObjContent::unused || content.counts[2] >= ObjContent::unused)
    throw FormatError(file.path().string() + ": more vertices or normals than can be numbered");
  finish_uses(content);
  return content;
}

}  // namespace bespoke
