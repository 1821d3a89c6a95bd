#pragma once

#include <vector>

#include "bespoke/flow/detail/face_gradients.h"

namespace bespoke {

/// Pairs of faces that share an edge.
struct FaceNeighbours {
  std::vector<int> start;  ///< m+1
  std::vector<int> faces;  ///< neighbours of face f are faces[start[f]] … faces[start[f + 1] - 1]
};

/// Over the mesh's vertex indices; along a non-manifold edge each face neighbours the next one.
FaceNeighbours face_neighbours(const TriangleMesh& mesh);

/// exp([w]) for a rotation vector w (axis times angle, radians).
Matrix3 rotation_of(const Vector3& vector);

/// The logarithm of a rotation, radians, that is nearest to `nearby` among all its branches (the axis times
/// angle + 2πk).
Vector3 rotation_vector_near(const Matrix3& rotation, const Vector3& nearby);

/// How every face turns: a rotation vector w with exp([w]) close to the rotation of its gradient D, such that
/// neighbours differ little and |w| may exceed π, and the rest S = exp(−[w]) D, so that exp([w]) S = D
/// whatever w is. S is a stretch (symmetric) wherever exp([w]) is the rotation of the polar decomposition.
class FaceRotations {
 public:
  /// `gradients` must outlive this. All faces are at rest (w = 0) until spread() has reached them.
  FaceRotations(const TriangleMesh& mesh, const FaceGradients& gradients);

  /// Chooses w for the faces of one piece of the surface. The face that turns least against exp([reference])
  /// takes the branch next to `reference`; from there the choice spreads over the neighbours, by least
  /// relative rotation first (a minimum spanning tree of the dual graph), each taking the branch next to its
  /// parent's. A face that turns by more than 120° against its parent was folded or collapsed by the fit: it
  /// takes its parent's w.
  void spread(const std::vector<int>& faces_of_piece, const Vector3& reference);

  Vector3 vector(Eigen::Index face) const { return vectors_.col(face); }  ///< radians
  Matrix3 rest(Eigen::Index face) const;                                  ///< S

  /// exp(t [w]) ((1−t) I + t S): the identity at t = 0, D at t = 1.
  Matrix3 at(Eigen::Index face, double t) const;

 private:
  double turn_between(int parent, int face) const;  // radians
  void take_branch(int face, const Vector3& nearby);

  const FaceGradients& gradients_;
  FaceNeighbours neighbours_;
  Points polar_;    // 3×3m, rotations of the polar decompositions
  Points vectors_;  // 3×m
  std::vector<char> reached_;
};

}  // namespace bespoke
