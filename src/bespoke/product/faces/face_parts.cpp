#include "bespoke/product/faces/face_parts.h"

#include <algorithm>

#include "bespoke/error.h"

namespace bespoke {

FaceParts::FaceParts(const FaceSplits& splits, std::size_t polygons, const std::filesystem::path& path)
    : splits_(splits), path_(path.string()) {
  if (splits.first_part.size() != polygons + 1) refuse();
  if (splits.part_corners.empty()) return;  // lines alone are split
  const int last = *std::max_element(splits.part_corners.begin(), splits.part_corners.end());
  first_made_ = last + 1 - static_cast<int>(splits.corners.size());
}

bool FaceParts::is_split(std::size_t polygon) const {
  return std::any_of(begin(first(polygon)), begin(first(polygon + 1)),
                     [&](int corner) { return corner >= first_made_; });
}

std::vector<int> FaceParts::corners(std::size_t polygon) const {
  std::vector<int> corners(begin(first(polygon)), begin(first(polygon + 1)));
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  return corners;
}

const FaceSplits::Corner* FaceParts::between(int corner) const {
  return corner < first_made_ ? nullptr : &splits_.corners[static_cast<std::size_t>(corner - first_made_)];
}

void FaceParts::require_own_corners(std::size_t polygon, std::size_t count) const {
  const std::vector<int> all = corners(polygon);
  const auto own = std::count_if(all.begin(), all.end(), [&](int corner) { return corner < first_made_; });
  if (static_cast<std::size_t>(own) != count) refuse();
}

void FaceParts::refuse() const {
  throw InvalidInput(path_ + ": it has other faces than those whose edges were split");
}

std::vector<int> FaceParts::corners_of_part(int part) const { return {begin(part), begin(part + 1)}; }

}  // namespace bespoke
