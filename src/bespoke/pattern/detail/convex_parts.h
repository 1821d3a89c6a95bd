#pragma once

#include <functional>
#include <vector>

#include "bespoke/types.h"

namespace bespoke {

/// A place in a face.
struct FaceCorner {
  int vertex = 0;
  Vector3 weights;  ///< of the face's corners, sum 1
};

/// A convex part of a face, counter-clockwise; corners may lie on straight sides.
using ConvexPart = std::vector<FaceCorner>;

/// Splits the parts of a face by the chord between two places of its border. crossing: makes a vertex where
/// it crosses a side between two parts.
void split_parts(std::vector<ConvexPart>& parts, const Vector3& from, const Vector3& to,
                 const std::function<int(const Vector3&)>& crossing);

/// The vertices of the parts on that chord, in order.
std::vector<int> vertices_along(const std::vector<ConvexPart>& parts, const Vector3& from, const Vector3& to);

/// Triangles that make up a part, none of them without area.
void visit_triangles(
    const ConvexPart& part,
    const std::function<void(const FaceCorner&, const FaceCorner&, const FaceCorner&)>& visit);

}  // namespace bespoke
