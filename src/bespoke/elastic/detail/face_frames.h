#pragma once

#include <vector>

#include "bespoke/mapping/elastic_map.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

class ExactMapReader;
class ExactMapWriter;

/// A source face and what carries it onto the fitted one.
struct FaceFrame {
  Vector3 a, ab, ac, normal;
  double bb, bc, cc, det;  ///< dot products of the edges and their Gram determinant
  double area;
  Vector3 shift;   ///< the face's affine map minus the background map, at the origin of the frames
  Matrix3 linear;  ///< the same difference's linear part
};

/// What both forms of p-FFD know of their two meshes.
struct FaceFrames {
  AffineMap affine;                ///< least squares over the vertices in use: the background map
  Vector3 origin;                  ///< in the middle of the source, so that the shifts lose few digits
  std::vector<int> mesh_faces;     ///< index in the source of each face with area
  std::vector<Matrix3> triangles;  ///< their corners as columns, mesh units
  std::vector<FaceFrame> frames;   ///< one each
};

/// source: reference; fitted: 3×n, its vertices on the target (source frame); lambda > 0, mesh units. Throws
/// InvalidInput, also when no face has any area.
FaceFrames face_frames(const TriangleMesh& source, const Points& fitted, double lambda);

/// Balls that hold all points within lambda (mesh units) of the given faces.
Support support_around(const TriangleMesh& mesh, const std::vector<int>& faces, double lambda);

/// What either form is made of.
struct FaceMap {
  TriangleMesh source;
  Points fitted;      ///< 3×n, mesh units
  double lambda = 0;  ///< mesh units
};

void write_face_map(const TriangleMesh& source, const Points& fitted, double lambda, ExactMapWriter& writer);
FaceMap read_face_map(ExactMapReader& reader);  ///< throws FormatError

}  // namespace bespoke
