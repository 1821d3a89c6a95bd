#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "bespoke/pattern/flat_pattern.h"

namespace bespoke {

/// A place on an outline, and the direction into the piece there.
struct OutlineMark {
  Eigen::Vector2d at;
  Eigen::Vector2d inward;
};

/// Along the sides of a seam, at the shares of their lengths: both get the same ones, in the same order.
std::array<std::vector<OutlineMark>, 2> seam_marks(const FlatPattern& pattern, const PatternSeam& seam,
                                                   const std::vector<double>& shares);

/// The notches of both sides of a seam: at its marks, and at equal parts of its length of at most 150 mm
/// where it has none near; none of these for less than 60 mm.
std::array<std::vector<OutlineMark>, 2> seam_notches(const FlatPattern& pattern, const PatternSeam& seam);

/// How wide a piece is across the grain at a place of it, millimetres: its left and its right end.
std::array<Eigen::Vector2d, 2> width_at(const Eigen::Matrix2Xd& outline, const Eigen::Vector2d& at);

/// The vertex inside that is farthest from the outline, and how far it is: where labels go.
struct WidePlace {
  Eigen::Vector2d at;
  double radius = 0;
};
WidePlace wide_place(const PatternPiece& piece);

/// The x of an upright line about which the piece is symmetric to 1 mm.
std::optional<double> fold_line(const PatternPiece& piece);

/// 2×k, the outline's places.
Eigen::Matrix2Xd outline_places(const PatternPiece& piece);

/// Of a closed line, counter-clockwise.
Eigen::Vector2d centre_of_area(const Eigen::Matrix2Xd& outline);

/// The lowest and the highest place of an upright line inside an outline around y: where the outline meets
/// it.
std::array<double, 2> upright_extent(const Eigen::Matrix2Xd& outline, const Eigen::Vector2d& at);

}  // namespace bespoke
