#include "bespoke/product/faces/gathered_faces.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bespoke/error.h"
#include "bespoke/mesh/equal_positions.h"

namespace bespoke {
namespace {

template <class Columns>
Columns joined(const std::vector<Columns>& parts, Eigen::Index columns) {
  Columns all(Columns::RowsAtCompileTime, columns);
  Eigen::Index at = 0;
  for (const Columns& part : parts) {
    all.middleCols(at, part.cols()) = part;
    at += part.cols();
  }
  return all;
}

}  // namespace

bool fits_float(double value) {
  return std::abs(value) <= static_cast<double>(std::numeric_limits<float>::max());
}

void require_countable(std::uint64_t vertices, const std::filesystem::path& path) {
  if (vertices > static_cast<std::uint64_t>(std::numeric_limits<int>::max()))
    throw FormatError(path.string() + ": " + std::to_string(vertices) +
                      " vertices are more than a reference model can number");
}

void FaceFaults::add(const std::vector<std::uint32_t>& faces) {
  std::vector<int> corners;
  for (std::size_t at = 0; at < faces.size(); ++faces_) {
    const std::size_t count = faces[at++];
    corners.assign(faces.begin() + static_cast<std::ptrdiff_t>(at),
                   faces.begin() + static_cast<std::ptrdiff_t>(at + count));
    at += count;
    std::string fault = face_fault(corners.data(), count, 0);
    if (fault.empty()) continue;
    if (count_++ > 0) continue;
    first_ = faces_;
    fault_ = std::move(fault);
  }
}

void FaceFaults::add(const FaceFaults& next) {
  if (count_ == 0 && next.count_ > 0) {
    first_ = faces_ + next.first_;
    fault_ = next.fault_;
  }
  faces_ += next.faces_;
  count_ += next.count_;
}

DegenerateFaces FaceFaults::degenerate(const std::filesystem::path& path) const {
  if (count_ == 0) return {};
  return {count_, path.string() + ": face " + std::to_string(first_) + ": " + fault_};
}

std::string face_fault(const int* corners, std::size_t count, int first) {
  if (count < 3) return "a face of " + std::to_string(count) + " corners";
  std::vector<int> sorted(corners, corners + count);
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  return twice == sorted.end() ? "" : "a face names vertex " + std::to_string(*twice + first) + " twice";
}

void GatheredFaces::add_points(const Points& points) {
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      if (!fits_float(points(axis, i)))
        throw FormatError(path_.string() + ": vertex " +
                          std::to_string(point_count_ + static_cast<std::size_t>(i)) + ": " + "xyz"[axis] +
                          " is not finite in single precision");
  point_count_ += static_cast<std::size_t>(points.cols());
  points_.push_back(points);
}

void GatheredFaces::add_texture(const Eigen::Matrix2Xd& texture) { texture_.push_back(texture); }

void GatheredFaces::add_normals(const Points& normals) { normals_.push_back(normals); }

void GatheredFaces::add_faces(const std::vector<std::uint32_t>& faces) {
  faults_.add(faces);
  for (std::size_t at = 0; at < faces.size();) {
    const std::size_t count = faces[at++];
    for (std::size_t k = 0; k < count; ++k) corners_.push_back(static_cast<int>(faces[at++]));
    if (corners_.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
      throw FormatError(path_.string() + ": more corners of faces than a reference model can number");
    polygon_start_.push_back(static_cast<int>(corners_.size()));
  }
}

Product GatheredFaces::product(bool has_normals) {
  Product product;
  product.has_normals = has_normals;
  product.degenerate = faults_.degenerate(path_);
  const auto count = static_cast<Eigen::Index>(point_count_);
  product.vertices = joined(points_, count);
  product.polygon_start = std::move(polygon_start_);
  product.corners = std::move(corners_);
  if (!normals_.empty()) product.normals = joined(normals_, count);
  if (texture_.empty()) return product;
  const Eigen::Matrix2Xd of_points = joined(texture_, count);
  product.texture.resize(2, static_cast<Eigen::Index>(product.corners.size()));
  for (std::size_t corner = 0; corner < product.corners.size(); ++corner)
    product.texture.col(static_cast<Eigen::Index>(corner)) = of_points.col(product.corners[corner]);
  return product;
}

std::vector<std::size_t> kept_triangles(const Points& corners) {
  std::vector<std::size_t> kept;
  for (Eigen::Index i = 0; i + 2 < corners.cols(); i += 3) {
    const auto a = corners.col(i), b = corners.col(i + 1), c = corners.col(i + 2);
    if (a != b && b != c && c != a) kept.push_back(static_cast<std::size_t>(i / 3));
  }
  return kept;
}

Product joined_triangles(const Points& corners, const Points& line_ends) {
  Points all(3, corners.cols() + line_ends.cols());
  all << corners, line_ends;
  const std::vector<int> first = first_at_equal_position(all);
  Product product;
  product.polygon_start.push_back(0);
  std::vector<int> vertex(first.size(), -1);
  std::vector<int> used;
  const auto number_of = [&](std::size_t corner) {
    int& number = vertex[static_cast<std::size_t>(first[corner])];
    if (number < 0) {
      number = static_cast<int>(used.size());
      used.push_back(first[corner]);
    }
    return number;
  };
  for (const std::size_t triangle : kept_triangles(corners)) {
    for (std::size_t k = 0; k < 3; ++k) product.corners.push_back(number_of(3 * triangle + k));
    product.polygon_start.push_back(static_cast<int>(product.corners.size()));
  }
  for (auto end = static_cast<std::size_t>(corners.cols()); end < first.size(); ++end)
    product.line_edges.push_back(number_of(end));
  product.vertices = all(Eigen::all, used);
  return product;
}

}  // namespace bespoke
