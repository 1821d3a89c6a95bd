#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "bespoke/product/face_splits.h"

namespace bespoke {

/// FaceSplits, polygon by polygon, for what a file says of corners.
class FaceParts {
 public:
  /// The splits must outlive it. Throws InvalidInput, naming the file, unless they are of so many polygons.
  FaceParts(const FaceSplits& splits, std::size_t polygons, const std::filesystem::path& path);

  /// Of all polygons.
  std::size_t count() const { return static_cast<std::size_t>(splits_.first_part.back()); }
  bool is_split(std::size_t polygon) const;

  /// The numbers of a polygon's corners, each once, ascending: those of the file, then those between others,
  /// which have smaller numbers.
  std::vector<int> corners(std::size_t polygon) const;
  /// None for a corner of the file.
  const FaceSplits::Corner* between(int corner) const;

  /// Number of a polygon's first part; that of the next polygon is behind its last.
  int first(std::size_t polygon) const { return splits_.first_part[polygon]; }
  std::vector<int> corners_of_part(int part) const;

  /// The corners of every part of a polygon, out of what the file says of the polygon's own corners, in their
  /// order, and of `middle(before, behind, vertex)` for what is between. Throws InvalidInput unless the split
  /// polygon has as many of its own.
  template <class Corner, class Middle>
  std::vector<std::vector<Corner>> parts(std::size_t polygon, const std::vector<Corner>& own,
                                         const Middle& middle) const {
    require_own_corners(polygon, own.size());
    std::map<int, Corner> vertex_data;
    std::size_t of_file = 0;
    for (const int number : corners(polygon)) {
      const FaceSplits::Corner* const made = between(number);
      vertex_data.emplace(
          number, made ? middle(vertex_data.at(made->before), vertex_data.at(made->behind), made->vertex)
                       : own[of_file++]);
    }
    std::vector<std::vector<Corner>> result;
    for (int part = first(polygon); part < first(polygon + 1); ++part) {
      result.emplace_back();
      for (const int number : corners_of_part(part)) result.back().push_back(vertex_data.at(number));
    }
    return result;
  }

 private:
  std::vector<int>::const_iterator begin(int part) const {
    return splits_.part_corners.begin() + splits_.part_start[static_cast<std::size_t>(part)];
  }

  void require_own_corners(std::size_t polygon, std::size_t count) const;
  [[noreturn]] void refuse() const;

  const FaceSplits& splits_;
  std::string path_;
  int first_made_ = 0;  // number of the first corner that the file does not have
};

}  // namespace bespoke
