#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bespoke/product/point_motion.h"
#include "bespoke/product/rigid_part.h"
#include "bespoke/types.h"

namespace bespoke {

/// A part of a product, with its points in the file (3×n).
struct PartPoints {
  RigidPart part;
  Points points;
  Points more;  ///< further places that move with it, but do not tell how
};

/// Parts out of three coordinates a point.
std::vector<PartPoints> parts_of(const std::vector<RigidPart>& parts,
                                 const std::vector<std::vector<double>>& coordinates);

/// How a part moves.
struct FittedPart {
  std::vector<AffineMap> frames;
  PartSummary summary;
};

/// The motion of least squares of the part's points onto their images. The identity, exactly, in a frame in
/// which none of them moves. Throws InvalidInput, naming the file, for points from which no turn can be told.
FittedPart fit_part(const PartPoints& part, const PointMotion& motion, const std::filesystem::path& file);

/// Throws UnknownPart: the file has no such part, but those that `known` lists.
[[noreturn]] void refuse_part(const std::string& name, const std::string& known,
                              const std::filesystem::path& file);

/// "a, b, c", the first hundred.
std::string listed(const std::vector<std::string>& names);

struct MotionWithParts {
  PointMotion motion;
  std::vector<PartSummary> parts;
};

/// `motion`, except for the points of the parts, which move as fit_part says of `parts`. What lies at the
/// same place as a point of `places` (the same parts, perhaps with more points), to the last bit, moves
/// alike, so that seams stay closed. Throws InvalidInput where two parts have a place in common.
MotionWithParts with_rigid_parts(const PointMotion& motion, const std::vector<PartPoints>& parts,
                                 const std::vector<PartPoints>& places, const std::filesystem::path& file);

/// For each point (3×n), the number of the part that has its place, or -1. Throws as with_rigid_parts.
std::vector<int> parts_at(const Points& points, const std::vector<PartPoints>& parts,
                          const std::filesystem::path& file);

}  // namespace bespoke
