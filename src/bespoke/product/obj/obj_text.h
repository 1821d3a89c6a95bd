#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <string_view>
#include <utility>
#include <vector>

#include "bespoke/product/text/text_blocks.h"

namespace bespoke {

/// Kinds of vertex data of an OBJ file: v, vt, vn.
enum ObjKind : std::size_t { obj_position, obj_texture, obj_normal, obj_kinds };
using ObjKinds = std::array<int, obj_kinds>;  ///< numbers from 0, or counts

inline constexpr int no_obj_data = -1;

/// Vertex data of one kind: those of the file in their order, then new ones in theirs, of which each stands
/// in front of one of the file.
class ObjVertexData {
 public:
  struct Number {
    double value = 0;
    int decimals = 0;
  };

  void add_of_file(std::vector<Number> numbers) {
    numbers_.push_back(std::move(numbers));
    ++of_file_;
  }

  /// In front of number `before` of the file, which must not fall. Returns the new one's number.
  int add(std::vector<Number> numbers, int before) {
    numbers_.push_back(std::move(numbers));
    before_.push_back(before);
    return of_file_ + added() - 1;
  }

  int of_file() const { return of_file_; }
  int added() const { return static_cast<int>(before_.size()); }
  const std::vector<Number>& numbers(int i) const { return numbers_[static_cast<std::size_t>(i)]; }

  /// The place of one among all, in the order in which they stand.
  int place(int i) const {
    if (i >= of_file_) return i - of_file_ + before_[static_cast<std::size_t>(i - of_file_)];
    return i + static_cast<int>(std::upper_bound(before_.begin(), before_.end(), i) - before_.begin());
  }

 private:
  int of_file_ = 0;
  std::vector<std::vector<Number>> numbers_;
  std::vector<int> before_;  // of the new ones
};

struct ObjElementCorner {
  std::string_view word;  ///< as it stands in the file; empty for a new one
  ObjKinds data{no_obj_data, no_obj_data, no_obj_data};
};

/// A face, a line or a point.
struct ObjElement {
  std::string_view text;  ///< from its first word to its last corner
  std::string_view keyword;
  bool is_face = false, is_line = false;
  ObjKinds before{};                     ///< vertex data of the file in front of it
  std::size_t first = 0, last = 0;       ///< its corners, in ObjText's faces or others
  ObjKinds made_before{}, made_until{};  ///< new ones in front of it, without and with its own
  std::vector<ObjKinds> split;           ///< what the corners of a line become; empty where it stays
};

struct ObjText {
  std::array<ObjVertexData, obj_kinds> data;
  std::vector<ObjElement> elements;
  std::vector<ObjElementCorner> faces;  ///< corners of faces, numbered as FaceSplits does
  std::vector<ObjElementCorner> others;
};

/// The vertex data of a text and what names them by numbers. The text is whole and checked
/// (check_obj_product), and must outlive what is returned.
ObjText read_obj_text(std::string_view text, const std::filesystem::path& path);

}  // namespace bespoke
