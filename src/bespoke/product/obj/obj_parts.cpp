#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <string>

#include "bespoke/error.h"
#include "bespoke/product/carry/product_formats.h"
#include "bespoke/product/obj/obj_check.h"
#include "bespoke/product/obj/obj_statements.h"

namespace bespoke {
namespace {

// What elements belong to: the statements in which names stand.
constexpr std::array<std::string_view, 3> part_keywords{"g", "o", "usemtl"};
constexpr std::array<const char*, 3> kinds{"groups", "objects", "materials"};

/// Elements behind one another, and the statements before them.
struct Run {
  std::array<std::optional<std::vector<std::string>>, 3> names;  ///< a group may have several
  std::vector<std::uint32_t> positions;                          ///< of the elements' corners, from 0
};

/// The words of a line, and all of them as one name, which may hold blanks.
std::vector<std::string> read_names(TextWords& words) {
  std::vector<std::string> names;
  std::string whole;
  for (std::string_view word = words.word(); !word.empty(); word = words.word()) {
    names.emplace_back(word);
    whole.append(whole.empty() ? "" : " ").append(word);
  }
  if (names.size() > 1) names.push_back(whole);
  return names;
}

std::vector<Run> read_runs(const TextBlock& block, const std::filesystem::path& path) {
  std::vector<Run> runs(1);
  TextWords words(block, path, obj_syntax);
  auto count = static_cast<long long>(block.before[0]);
  while (words.next_line()) {
    const std::string_view keyword = words.word();
    const auto kind = std::find(part_keywords.begin(), part_keywords.end(), keyword);
    if (kind != part_keywords.end()) {
      if (!runs.back().positions.empty()) runs.emplace_back();
      runs.back().names[static_cast<std::size_t>(kind - part_keywords.begin())] = read_names(words);
      continue;
    }
    const ObjStatement statement = obj_statement(keyword);
    count += statement == ObjStatement::position;
    if (statement != ObjStatement::face && statement != ObjStatement::line &&
        statement != ObjStatement::point)
      continue;
    for (std::string_view word = words.word(); !word.empty(); word = words.word()) {
      const std::optional<ObjCorner> corner = read_corner(word);
      if (!corner) words.fail("the corner " + in_quotes(word));
      const long long written = corner->index[0];
      runs.back().positions.push_back(
          static_cast<std::uint32_t>((written < 0 ? count + 1 + written : written) - 1));
    }
  }
  return runs;
}

/// Which part each position belongs to.
class PartMarks {
 public:
  PartMarks(const std::vector<RigidPart>& parts, std::size_t positions)
      : parts_(parts), marks_(positions, none) {}

  static constexpr std::uint32_t none = 0xffffffff;
  std::uint32_t operator[](std::size_t position) const { return marks_[position]; }

  void add(Run&& run, const std::filesystem::path& path) {
    for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
      if (!run.names[kind]) continue;
      current_[kind] = std::move(*run.names[kind]);
      known_[kind].insert(current_[kind].begin(), current_[kind].end());
    }
    for (std::uint32_t part = 0; part < parts_.size(); ++part) {
      const bool is_in = std::any_of(current_.begin(), current_.end(), [&](const auto& names) {
        return std::find(names.begin(), names.end(), parts_[part].name) != names.end();
      });
      if (is_in) mark(run.positions, part, path);
    }
  }

  void require_all(const std::filesystem::path& path) const {
    for (std::uint32_t part = 0; part < parts_.size(); ++part) {
      if (std::find(marks_.begin(), marks_.end(), part) != marks_.end()) continue;
      std::string text;
      for (std::size_t kind = 0; kind < kinds.size(); ++kind)
        if (!known_[kind].empty())
          text += (text.empty() ? "its " : ", its ") + std::string(kinds[kind]) + " are " +
                  listed({known_[kind].begin(), known_[kind].end()});
      refuse_part(parts_[part].name, text.empty() ? "it has no groups, objects or materials" : text, path);
    }
  }

 private:
  void mark(const std::vector<std::uint32_t>& positions, std::uint32_t part,
            const std::filesystem::path& path) {
    for (const std::uint32_t position : positions) {
      std::uint32_t& mark = marks_.at(position);
      if (mark != none && mark != part)
        throw InvalidInput(path.string() + ": the parts '" + parts_[mark].name + "' and '" +
                           parts_[part].name + "' share vertex " + std::to_string(position + 1) +
                           ", so they cannot both keep their shape");
      mark = part;
    }
  }

  const std::vector<RigidPart>& parts_;
  std::vector<std::uint32_t> marks_;
  std::array<std::vector<std::string>, 3> current_;
  std::array<std::set<std::string>, 3> known_;
};

}  // namespace

std::vector<PartPoints> find_obj_parts(const InputFile& file, const std::vector<RigidPart>& parts,
                                       const Progress& progress) {
  const ObjContent content = check_obj_product(file, progress);
  PartMarks marks(parts, static_cast<std::size_t>(content.counts[0]));
  TextCutter cutter(file.path(), 1, count_obj);
  walk_blocks(
      {file, 0}, [&](const Window& window) { return cutter(window); },
      [&](const TextBlock& block) { return read_runs(block, file.path()); },
      [&](const TextBlock&, std::vector<Run>&& runs) {
        for (Run& run : runs) marks.add(std::move(run), file.path());
      },
      progress);
  marks.require_all(file.path());

  std::vector<std::vector<double>> coordinates(parts.size());
  TextCutter again(file.path(), 1, count_obj);
  walk_blocks(
      {file, 0}, [&](const Window& window) { return again(window); },
      [&](const TextBlock& block) {
        std::vector<NumberTriple> positions;
        TextWords words(block, file.path(), obj_syntax);
        while (words.next_line())
          if (obj_statement(words.word()) == ObjStatement::position) positions.push_back(read_triple(words));
        return positions;
      },
      [&](const TextBlock& block, std::vector<NumberTriple>&& positions) {
        for (std::size_t i = 0; i < positions.size(); ++i) {
          const std::uint32_t part = marks[static_cast<std::size_t>(block.before[0]) + i];
          if (part == PartMarks::none) continue;
          for (const NumberText& number : positions[i]) coordinates[part].push_back(number.value);
        }
      },
      progress);
  return parts_of(parts, coordinates);
}

std::vector<std::string> find_obj_groups(const InputFile& file) {
  const ObjContent content = check_obj_product(file, {});
  std::vector<std::string> groups(static_cast<std::size_t>(content.counts[0]));
  std::string group, object;
  TextCutter cutter(file.path(), 1, count_obj);
  walk_blocks(
      {file, 0}, [&](const Window& window) { return cutter(window); },
      [&](const TextBlock& block) { return read_runs(block, file.path()); },
      [&](const TextBlock&, std::vector<Run>&& runs) {
        const auto whole = [](const std::vector<std::string>& names) {
          return names.empty() ? std::string() : names.back();
        };
        for (const Run& run : runs) {
          if (run.names[0]) group = whole(*run.names[0]);
          if (run.names[1]) object = whole(*run.names[1]);
          for (const std::uint32_t position : run.positions)
            groups.at(position) = group.empty() ? object : group;
        }
      },
      {});
  return groups;
}

}  // namespace bespoke
