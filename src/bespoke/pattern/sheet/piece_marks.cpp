#include "bespoke/pattern/sheet/piece_marks.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bespoke/pattern/flattening/paired_seams.h"

namespace bespoke {
namespace {

// Labels and folds need no more: a piece's middle is wide.
constexpr Eigen::Index searched_vertices = 600;

double distance_to_segment(const Eigen::Vector2d& x, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const double share = std::clamp((x - a).dot(b - a) / std::max((b - a).squaredNorm(), 1e-300), 0.0, 1.0);
  return (x - a - share * (b - a)).norm();
}

double distance_to_outline(const Eigen::Vector2d& x, const Eigen::Matrix2Xd& outline) {
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index k = 0; k < outline.cols(); ++k)
    least = std::min(least, distance_to_segment(x, outline.col(k), outline.col((k + 1) % outline.cols())));
  return least;
}

OutlineMark mark_at(const Eigen::Matrix2Xd& side, double share, bool is_reversed) {
  std::vector<double> along{0};
  for (Eigen::Index k = 0; k + 1 < side.cols(); ++k)
    along.push_back(along.back() + (side.col(k + 1) - side.col(k)).norm());
  const double wanted = share * along.back();
  Eigen::Index k = 0;
  while (k + 2 < side.cols() && along[static_cast<std::size_t>(k) + 1] < wanted) ++k;
  const double begin = along[static_cast<std::size_t>(k)];
  const Eigen::Vector2d step = side.col(k + 1) - side.col(k);
  const Eigen::Vector2d along_side = step.normalized() * (is_reversed ? -1 : 1);
  return {side.col(k) + step * ((wanted - begin) / step.norm()), {-along_side.y(), along_side.x()}};
}

/// Equal parts of a length, in shares of it.
std::vector<double> notch_shares(double length) {
  constexpr double spacing = 150, shortest = 60;  // millimetres, as tailors notch sleeves and side seams
  if (length < shortest) return {};
  const int parts = std::max(2, static_cast<int>(std::ceil(length / spacing)));
  std::vector<double> shares;
  for (int k = 1; k < parts; ++k) shares.push_back(static_cast<double>(k) / parts);
  return shares;
}

/// The place that lies as far along a side of `places` (2×k), in shares of its length.
double share_of(const Eigen::Matrix2Xd& side, const SeamPlace& place) {
  double before = 0, whole = 0;
  for (Eigen::Index k = 0; k + 1 < side.cols(); ++k) {
    const double step = (side.col(k + 1) - side.col(k)).norm();
    if (k < place.edge) before += step;
    if (k == place.edge) before += place.share * step;
    whole += step;
  }
  return whole > 0 ? before / whole : 0;
}

Eigen::Matrix2Xd side_places(const FlatPattern& pattern, const SeamSide& side) {
  return pattern.pieces[static_cast<std::size_t>(side.piece)].flat(Eigen::all, side.vertices);
}

}  // namespace

std::array<std::vector<OutlineMark>, 2> seam_marks(const FlatPattern& pattern, const PatternSeam& seam,
                                                   const std::vector<double>& shares) {
  std::array<std::vector<OutlineMark>, 2> marks;
  for (std::size_t side = 0; side < 2; ++side) {
    const Eigen::Matrix2Xd places = side_places(pattern, seam.seam.sides[side]);
    for (const double share : shares) marks[side].push_back(mark_at(places, share, side == 1));
  }
  return marks;
}

std::array<std::vector<OutlineMark>, 2> seam_notches(const FlatPattern& pattern, const PatternSeam& seam) {
  constexpr double apart = 15;  // millimetres, that one notch is told from the next
  const double length = std::max(seam.lengths[0], seam.lengths[1]);
  const Eigen::Matrix2Xd first = side_places(pattern, seam.seam.sides[0]);
  std::vector<double> shares = notch_shares(length);
  std::erase_if(shares, [&](double share) {
    return std::any_of(seam.marks.begin(), seam.marks.end(), [&](const SeamPlace& mark) {
      return std::abs(share_of(first, mark) - share) * length < apart;
    });
  });
  auto notches = seam_marks(pattern, seam, shares);
  for (std::size_t side = 0; side < 2; ++side) {
    const Eigen::Matrix2Xd places = side_places(pattern, seam.seam.sides[side]);
    for (const SeamPlace& mark : seam.marks)
      notches[side].push_back(mark_at(places, share_of(places, mark), side == 1));
  }
  return notches;
}

std::array<Eigen::Vector2d, 2> width_at(const Eigen::Matrix2Xd& outline, const Eigen::Vector2d& at) {
  Eigen::Matrix2d quarter_turn;
  quarter_turn << 0, 1, -1, 0;  // (x, y) to (y, -x): what is to the right is below
  const auto [low, high] = upright_extent(quarter_turn * outline, quarter_turn * at);
  return {Eigen::Vector2d(-high, at.y()), Eigen::Vector2d(-low, at.y())};
}

Eigen::Matrix2Xd outline_places(const PatternPiece& piece) {
  return piece.flat(Eigen::all, piece.piece.outline);
}

WidePlace wide_place(const PatternPiece& piece) {
  const Eigen::Matrix2Xd outline = outline_places(piece);
  WidePlace best{piece.flat(Eigen::all, piece.piece.mesh.faces.col(0)).rowwise().mean(), 0};
  best.radius = distance_to_outline(best.at, outline);
  const Eigen::Index step = std::max<Eigen::Index>(1, piece.piece.mesh.faces.cols() / searched_vertices);
  for (Eigen::Index f = 0; f < piece.piece.mesh.faces.cols(); f += step) {
    const Eigen::Vector2d x = piece.flat(Eigen::all, piece.piece.mesh.faces.col(f)).rowwise().mean();
    const double radius = distance_to_outline(x, outline);
    if (radius > best.radius) best = {x, radius};
  }
  return best;
}

Eigen::Vector2d centre_of_area(const Eigen::Matrix2Xd& outline) {
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();
  double twice_area = 0;
  const Eigen::Vector2d origin = outline.col(0);
  for (Eigen::Index k = 0; k < outline.cols(); ++k) {
    const Eigen::Vector2d a = outline.col(k) - origin, b = outline.col((k + 1) % outline.cols()) - origin;
    const double cross = a.x() * b.y() - a.y() * b.x();
    moment += cross / 3 * (a + b);
    twice_area += cross;
  }
  return twice_area == 0 ? origin : Eigen::Vector2d(origin + moment / twice_area);
}

std::optional<double> fold_line(const PatternPiece& piece) {
  constexpr double tolerance = 1;  // millimetres, as of seams
  const Eigen::Matrix2Xd outline = outline_places(piece);
  const double x = centre_of_area(outline).x();
  const Eigen::Index step = std::max<Eigen::Index>(1, outline.cols() / searched_vertices);
  for (Eigen::Index k = 0; k < outline.cols(); k += step)
    if (distance_to_outline({2 * x - outline(0, k), outline(1, k)}, outline) > tolerance) return {};
  return x;
}

std::array<double, 2> upright_extent(const Eigen::Matrix2Xd& outline, const Eigen::Vector2d& at) {
  double low = -std::numeric_limits<double>::infinity(), high = -low;
  for (Eigen::Index k = 0; k < outline.cols(); ++k) {
    const Eigen::Vector2d a = outline.col(k), b = outline.col((k + 1) % outline.cols());
    if ((a.x() > at.x()) == (b.x() > at.x())) continue;
    const double y = a.y() + (b.y() - a.y()) * ((at.x() - a.x()) / (b.x() - a.x()));
    if (y <= at.y()) low = std::max(low, y);
    if (y >= at.y()) high = std::min(high, y);
  }
  if (!std::isfinite(low) || !std::isfinite(high)) return {at.y(), at.y()};
  return {low, high};
}

}  // namespace bespoke
