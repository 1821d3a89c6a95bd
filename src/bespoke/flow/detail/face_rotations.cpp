#include "bespoke/flow/detail/face_rotations.h"

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <queue>
#include <tuple>
#include <utility>

#include "bespoke/mesh/mesh_edges.h"
#include "bespoke/parallel.h"
#include "bespoke/rigid/nearest_rotation.h"

namespace bespoke {
namespace {

// Beyond it two neighbours are no part of one smooth motion, radians. Joints of the shared models turn
// neighbouring faces by some 10° against each other, folds of a fit by almost 180°.
constexpr double largest_neighbour_turn = 2 * std::numbers::pi / 3;

// Rotations this small have no axis of their own, radians.
constexpr double no_turn = 1e-9;

/// A face to be reached from `parent`; ordered by the rotation between the two, then by index, so that the
/// tree is the same everywhere.
struct Candidate {
  double turn = 0;
  int face = 0;
  int parent = 0;
  bool operator>(const Candidate& other) const {
    return std::tie(turn, face, parent) > std::tie(other.turn, other.face, other.parent);
  }
};

}  // namespace

FaceNeighbours face_neighbours(const TriangleMesh& mesh) {
  const MeshEdges edges = mesh_edges(mesh);
  std::vector<int> last(edges.edges.size(), MeshEdges::none);
  std::vector<std::pair<int, int>> pairs;
  for (int face = 0; face < static_cast<int>(mesh.faces.cols()); ++face)
    for (const int edge : edges.of_face.col(face)) {
      if (edge == MeshEdges::none) continue;
      int& before = last[static_cast<std::size_t>(edge)];
      if (before != MeshEdges::none) pairs.emplace_back(before, face);
      before = face;
    }
  FaceNeighbours neighbours;
  neighbours.start.assign(static_cast<std::size_t>(mesh.faces.cols()) + 1, 0);
  const auto count = [&](int face) { ++neighbours.start[static_cast<std::size_t>(face) + 1]; };
  for (const auto& [a, b] : pairs) count(a), count(b);
  for (std::size_t i = 1; i < neighbours.start.size(); ++i) neighbours.start[i] += neighbours.start[i - 1];
  std::vector<int> next(neighbours.start.begin(), neighbours.start.end() - 1);
  neighbours.faces.resize(2 * pairs.size());
  const auto add = [&](int face, int other) {
    neighbours.faces[static_cast<std::size_t>(next[static_cast<std::size_t>(face)]++)] = other;
  };
  for (const auto& [a, b] : pairs) add(a, b), add(b, a);
  return neighbours;
}

Matrix3 rotation_of(const Vector3& vector) {
  const double angle = vector.norm();
  if (!(angle > 0)) return Matrix3::Identity();
  return Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix();
}

Vector3 rotation_vector_near(const Matrix3& rotation, const Vector3& nearby) {
  const Eigen::AngleAxisd principal(rotation);
  constexpr double turn = 2 * std::numbers::pi;
  const double length = nearby.norm();
  // Next to no rotation is one of 2πk about any axis.
  if (principal.angle() < no_turn)
    return length > 0 ? Vector3(turn * std::round(length / turn) / length * nearby) : Vector3::Zero();
  const double branch = std::round((nearby.dot(principal.axis()) - principal.angle()) / turn);
  return (principal.angle() + turn * branch) * principal.axis();
}

FaceRotations::FaceRotations(const TriangleMesh& mesh, const FaceGradients& gradients)
    : gradients_(gradients),
      neighbours_(face_neighbours(mesh)),
      polar_(3, 3 * gradients.faces()),
      vectors_(Points::Zero(3, gradients.faces())),
      reached_(static_cast<std::size_t>(gradients.faces()), 0) {
  parallel_for(reached_.size(), faces_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (auto face = static_cast<Eigen::Index>(begin); face < static_cast<Eigen::Index>(end); ++face)
      polar_.middleCols<3>(3 * face) = nearest_rotation(gradients.of(face)).rotation;
  });
}

void FaceRotations::spread(const std::vector<int>& faces_of_piece, const Vector3& reference) {
  const Matrix3 rotation = rotation_of(reference);
  Candidate seed{std::numeric_limits<double>::infinity(), 0, 0};
  for (const int face : faces_of_piece) {
    const Matrix3 relative = rotation.transpose() * polar_.middleCols<3>(3 * face);
    const Candidate candidate{Eigen::AngleAxisd(relative).angle(), face, face};
    if (gradients_.areas[face] > 0 && seed > candidate) seed = candidate;
  }
  if (!std::isfinite(seed.turn)) return;
  take_branch(seed.face, reference);

  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue;
  const auto look_around = [&](int face) {
    const auto at = static_cast<std::size_t>(face);
    for (int k = neighbours_.start[at]; k < neighbours_.start[at + 1]; ++k) {
      const int other = neighbours_.faces[static_cast<std::size_t>(k)];
      if (!reached_[static_cast<std::size_t>(other)]) queue.push({turn_between(face, other), other, face});
    }
  };
  look_around(seed.face);
  while (!queue.empty()) {
    const Candidate next = queue.top();
    queue.pop();
    if (reached_[static_cast<std::size_t>(next.face)]) continue;
    // A face without area knows nothing of its own, and hands on what it was told.
    if (!(gradients_.areas[next.face] > 0))
      polar_.middleCols<3>(3 * next.face) = polar_.middleCols<3>(3 * next.parent);
    take_branch(next.face, vectors_.col(next.parent));
    look_around(next.face);
  }
}

double FaceRotations::turn_between(int parent, int face) const {
  if (!(gradients_.areas[face] > 0)) return 0;
  const Matrix3 relative = polar_.middleCols<3>(3 * parent).transpose() * polar_.middleCols<3>(3 * face);
  return Eigen::AngleAxisd(relative).angle();
}

void FaceRotations::take_branch(int face, const Vector3& nearby) {
  const Vector3 vector = rotation_vector_near(polar_.middleCols<3>(3 * face), nearby);
  vectors_.col(face) = (vector - nearby).norm() <= largest_neighbour_turn ? vector : nearby;
  reached_[static_cast<std::size_t>(face)] = 1;
}

Matrix3 FaceRotations::rest(Eigen::Index face) const {
  return rotation_of(vectors_.col(face)).transpose() * gradients_.of(face);
}

Matrix3 FaceRotations::at(Eigen::Index face, double t) const {
  return rotation_of(t * vectors_.col(face)) * ((1 - t) * Matrix3::Identity() + t * rest(face));
}

}  // namespace bespoke
