#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "bespoke/product/faces/face_group_formats.h"
#include "bespoke/product/obj/obj_check.h"
#include "bespoke/product/obj/obj_statements.h"

namespace bespoke {
namespace {

// By FaceGroupKind.
constexpr std::array<std::string_view, 3> group_keywords{"g", "o", "usemtl"};

/// Faces behind one another, and the name that a statement before them gives them.
struct NamedFaces {
  std::optional<std::string> name;
  std::size_t faces = 0;
};

std::vector<NamedFaces> named_faces(const TextBlock& block, const std::filesystem::path& path,
                                    std::string_view keyword) {
  std::vector<NamedFaces> runs(1);
  TextWords words(block, path, obj_syntax);
  while (words.next_line()) {
    const std::string_view word = words.word();
    if (word == keyword) {
      std::string name;
      for (std::string_view part = words.word(); !part.empty(); part = words.word())
        name.append(name.empty() ? "" : " ").append(part);
      runs.push_back({std::move(name), 0});
    } else if (obj_statement(word) == ObjStatement::face) {
      ++runs.back().faces;
    }
  }
  return runs;
}

}  // namespace

std::vector<std::string> find_obj_face_groups(const InputFile& file, FaceGroupKind kind) {
  const std::string_view keyword = group_keywords[static_cast<std::size_t>(kind)];
  std::vector<std::string> of_faces;
  std::string current;
  TextCutter cutter(file.path(), 1, count_obj);
  walk_blocks(
      {file, 0}, [&](const Window& window) { return cutter(window); },
      [&](const TextBlock& block) { return named_faces(block, file.path(), keyword); },
      [&](const TextBlock&, std::vector<NamedFaces>&& runs) {
        for (NamedFaces& run : runs) {
          if (run.name) current = std::move(*run.name);
          of_faces.insert(of_faces.end(), run.faces, current);
        }
      },
      {});
  return of_faces;
}

}  // namespace bespoke
