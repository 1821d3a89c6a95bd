#include "bespoke/grading/detail/surface_line.h"

#include <string>
#include <utility>
#include <vector>

#include "bespoke/error.h"

namespace bespoke {
namespace {

// Halvings of a piece: a model's diagonal becomes a millionth of itself. A piece that is longer than the
// spacing after that crosses a gap: the middle of the gap is closest to one of its sides again and again.
constexpr int max_halvings = 20;

// Sweeps that shorten the line before it is halved further: the middle of a long chord lies deep below the
// surface and is projected beside the shortest line. Over the shoulders of a body the line is 0.2 % too long
// with none, 0.02 % with two, and no shorter with more than eight.
constexpr int sweeps = 4;

struct LinePoint {
  Vector3 place;
  std::size_t corner = 0;  ///< the number, from 1, of the given point that it is or follows
  bool is_corner = false;
};

using Line = std::vector<LinePoint>;

/// Pairs of neighbours: the last and the first are in a closed line.
std::size_t pieces(const Line& line, bool closed) { return line.size() - (closed ? 0 : 1); }

const LinePoint& after(const Line& line, std::size_t i) { return line[(i + 1) % line.size()]; }

/// With the closest point of the middle in every piece that is longer than the spacing.
Line halved(const ClosestPointTree& surface, const Line& line, const SurfaceLineOptions& options) {
  Line finer;
  for (std::size_t i = 0; i < line.size(); ++i) {
    finer.push_back(line[i]);
    if (i == pieces(line, options.closed)) continue;
    const Vector3 to = after(line, i).place;
    if ((to - line[i].place).norm() > options.spacing)
      finer.push_back({surface.closest((line[i].place + to) / 2)->point, line[i].corner});
  }
  return finer;
}

/// Each point but the given ones to the closest point of its neighbours' middle.
void shorten(const ClosestPointTree& surface, Line& line) {
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i].is_corner) continue;  // the ends of an open line are
    const Vector3 before = line[i - 1].place;
    line[i].place = surface.closest((before + after(line, i).place) / 2)->point;
  }
}

Line corners_of(const ClosestPointTree& surface, const Points& points) {
  Line line;
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    line.push_back({surface.closest(points.col(i))->point, static_cast<std::size_t>(i) + 1, true});
  return line;
}

[[noreturn]] void fail_at_gap(const Line& line, bool closed, Eigen::Index corners) {
  std::size_t gap = 0;
  double longest = 0;
  for (std::size_t i = 0; i < pieces(line, closed); ++i) {
    const double length = (after(line, i).place - line[i].place).norm();
    if (length <= longest) continue;
    longest = length;
    gap = line[i].corner;
  }
  throw InvalidInput("no way over the surface was found from its point " + std::to_string(gap) +
                     " to its point " + std::to_string(gap % static_cast<std::size_t>(corners) + 1) +
                     "; give points between them");
}

}  // namespace

Points surface_line(const ClosestPointTree& surface, const Points& points,
                    const SurfaceLineOptions& options) {
  if (!(options.spacing > 0)) throw InvalidInput("the spacing of a line over a surface must be above 0");
  if (points.cols() < (options.closed ? 3 : 2))
    throw InvalidInput("a loop needs three points or more, a path two");
  Line line = corners_of(surface, points);
  for (int halvings = 0;; ++halvings) {
    Line finer = halved(surface, line, options);
    if (finer.size() == line.size()) break;
    if (halvings == max_halvings) fail_at_gap(line, options.closed, points.cols());
    line = std::move(finer);
    for (int sweep = 0; sweep < sweeps; ++sweep) shorten(surface, line);
  }
  Points columns(3, static_cast<Eigen::Index>(line.size()));
  for (std::size_t i = 0; i < line.size(); ++i) columns.col(static_cast<Eigen::Index>(i)) = line[i].place;
  return columns;
}

}  // namespace bespoke
