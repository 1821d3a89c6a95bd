#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "bespoke/product/product_io.h"

namespace bespoke {

/// Counts the degenerate ones of a file's faces, block by block.
class FaceFaults {
 public:
  /// Of each face the number of its corners, and the corners.
  void add(const std::vector<std::uint32_t>& faces);
  void add(const FaceFaults& next);
  DegenerateFaces degenerate(const std::filesystem::path& path) const;

 private:
  std::size_t faces_ = 0, count_ = 0, first_ = 0;
  std::string fault_;  ///< of the first one
};

/// Polygons and their vertices while a file is read.
class GatheredFaces {
 public:
  /// The path, for messages, must outlive it.
  explicit GatheredFaces(const std::filesystem::path& path) : path_(path) {}

  /// Each throws FormatError naming the vertex at fault. Degenerate faces are counted.
  void add_points(const Points& points);
  void add_texture(const Eigen::Matrix2Xd& texture);  ///< of points
  void add_normals(const Points& normals);            ///< of points
  /// Of each face the number of its corners, and the corners.
  void add_faces(const std::vector<std::uint32_t>& faces);

  /// A texture coordinate of a point becomes one of its corners.
  Product product(bool has_normals);

 private:
  const std::filesystem::path& path_;
  std::vector<Points> points_, normals_;
  std::vector<Eigen::Matrix2Xd> texture_;
  std::size_t point_count_ = 0;
  std::vector<int> polygon_start_{0}, corners_;
  FaceFaults faults_;
};

/// Triangles of formats without shared vertices, or that share them only where all else is equal too: three
/// corners each, 3×3m. One vertex for all corners at exactly one place, in the order of their first use;
/// triangles of which two corners coincide are left out. Lines, two ends an edge, are all kept; their
/// vertices follow those of the triangles.
Product joined_triangles(const Points& corners, const Points& line_ends = Points(3, 0));

/// The numbers of the triangles that joined_triangles keeps, ascending.
std::vector<std::size_t> kept_triangles(const Points& corners);

/// What is wrong with a face: fewer than three corners, or one that occurs twice, numbered from `first`.
/// Empty when nothing is.
std::string face_fault(const int* corners, std::size_t count, int first);

/// Counts one more; `text()`, a "path:line: what", is called for the first one only, since it counts the
/// lines of a block.
template <class Text>
void add(DegenerateFaces& faces, const Text& text) {
  if (faces.count++ == 0) faces.first = text();
}

/// Throws FormatError, naming the file, for more than `int` can number.
void require_countable(std::uint64_t vertices, const std::filesystem::path& path);

/// Whether a value is finite and in a float's range, which is that of what maps store.
bool fits_float(double value);

}  // namespace bespoke
