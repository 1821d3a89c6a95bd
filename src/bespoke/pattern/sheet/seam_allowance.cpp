#include "bespoke/pattern/sheet/seam_allowance.h"

#include <cmath>
#include <polyclipping/clipper.hpp>

namespace bespoke {

std::vector<std::vector<Eigen::Vector2d>> with_allowance(const Eigen::Matrix2Xd& outline, double allowance,
                                                         AllowanceCorners corners) {
  constexpr double per_mm = 1e4;     // a hundredth of the files' last digit
  constexpr double miter_limit = 2;  // times the allowance: corners down to 60 degrees stay mitred
  ClipperLib::Path path;
  for (const auto& x : outline.colwise())
    path.emplace_back(std::llround(per_mm * x.x()), std::llround(per_mm * x.y()));
  ClipperLib::ClipperOffset offset(miter_limit);
  offset.AddPath(path, corners == AllowanceCorners::mitred ? ClipperLib::jtMiter : ClipperLib::jtSquare,
                 ClipperLib::etClosedPolygon);
  ClipperLib::Paths paths;
  offset.Execute(paths, per_mm * allowance);
  std::vector<std::vector<Eigen::Vector2d>> lines;
  for (const ClipperLib::Path& found : paths) {
    if (!ClipperLib::Orientation(found)) continue;  // a hole between parts that the allowance closes
    lines.emplace_back();
    for (const ClipperLib::IntPoint& point : found)
      lines.back().emplace_back(static_cast<double>(point.X) / per_mm, static_cast<double>(point.Y) / per_mm);
  }
  return lines;
}

}  // namespace bespoke
