#include "bespoke/flow/surface_path.h"

#include <Eigen/SVD>
#include <algorithm>
#include <string>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/flow/detail/edge_poisson.h"
#include "bespoke/flow/detail/face_rotations.h"
#include "bespoke/flow/detail/region_means.h"
#include "bespoke/flow/detail/surface_pieces.h"
#include "bespoke/mesh/equal_positions.h"

namespace bespoke {
namespace {

/// The source with one vertex per place.
struct Places {
  TriangleMesh mesh;
  Points fitted;               // mean of the vertices at the place
  std::vector<int> of_vertex;  // n
};

Places places_of(const TriangleMesh& source, const Points& fitted) {
  const EqualPositions equal = equal_positions(source.vertices);
  const auto count = static_cast<Eigen::Index>(equal.groups());
  Places places{{Points(3, count), source.faces},
                Points(3, count),
                std::vector<int>(static_cast<std::size_t>(source.vertices.cols()))};
  for (std::size_t group = 0; group < equal.groups(); ++group) {
    const auto place = static_cast<Eigen::Index>(group);
    Vector3 sum = Vector3::Zero();
    for (const int vertex : equal.group(group)) {
      sum += fitted.col(vertex);
      places.of_vertex[static_cast<std::size_t>(vertex)] = static_cast<int>(group);
    }
    places.mesh.vertices.col(place) = source.vertices.col(equal.group(group).front());
    places.fitted.col(place) = sum / static_cast<double>(equal.group(group).size());
  }
  for (int& vertex : places.mesh.faces.reshaped())
    vertex = places.of_vertex[static_cast<std::size_t>(vertex)];
  return places;
}

std::vector<int> first_vertices(const std::vector<SurfacePiece>& pieces) {
  std::vector<int> first;
  for (const SurfacePiece& piece : pieces) first.push_back(piece.vertices.front());
  return first;
}

/// A piece with links turns as the surface at its first link does.
FaceRotations spread_rotations(const TriangleMesh& mesh, const FaceGradients& gradients,
                               const std::vector<SurfacePiece>& pieces,
                               const std::vector<std::vector<PieceLink>>& links) {
  FaceRotations rotations(mesh, gradients);
  for (std::size_t i = 0; i < pieces.size(); ++i)
    rotations.spread(pieces[i].faces,
                     links[i].empty() ? Vector3::Zero() : rotations.vector(links[i].front().face));
  return rotations;
}

Vector3 mean_of(const Points& points, const std::vector<int>& columns) {
  return points(Eigen::all, columns).rowwise().mean();
}

void require_usable(const TriangleMesh& source, const Points& fitted) {
  require_valid(source, "source");
  if (fitted.cols() != source.vertices.cols() || !fitted.allFinite())
    throw InvalidInput("the surfaces between source and fitted source: " + std::to_string(fitted.cols()) +
                       " fitted positions, or some that are not finite, for " +
                       std::to_string(source.vertices.cols()) + " vertices");
}

}  // namespace

struct SurfacePath::Parts {
  Parts(const TriangleMesh& mesh, const Points& fitted_vertices)
      : source(mesh.vertices),
        fitted(fitted_vertices),
        places(places_of(mesh, fitted)),
        gradients(face_gradients(places.mesh, places.fitted)),
        pieces(surface_pieces(places.mesh, gradients.areas)),
        links(piece_links(places.mesh, gradients.areas, pieces)),
        rotations(spread_rotations(places.mesh, gradients, pieces, links)),
        poisson(places.mesh, gradients.areas, first_vertices(pieces)),
        start(placed(0)),
        end(placed(1)) {}

  /// The solution of the Poisson equation with every piece in its place.
  Points placed(double t) const {
    Points x = poisson.solve(rotations, t);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      const Vector3 shift = links[i].empty() ? mean_shift(pieces[i], x, t) : link_shift(links[i], x, t);
      for (const int vertex : pieces[i].vertices) x.col(vertex) += shift;
    }
    return x;
  }

  Vector3 mean_shift(const SurfacePiece& piece, const Points& x, double t) const {
    return (1 - t) * mean_of(places.mesh.vertices, piece.vertices) +
           t * mean_of(places.fitted, piece.vertices) - mean_of(x, piece.vertices);
  }

  /// A link turns with the surface that it starts from.
  Vector3 link_shift(const std::vector<PieceLink>& of_piece, const Points& x, double t) const {
    Vector3 sum = Vector3::Zero();
    for (const PieceLink& link : of_piece) {
      const Vector3 before =
          places.mesh.vertices.col(link.vertex) - link.foot(places.mesh, places.mesh.vertices);
      const Vector3 after = places.fitted.col(link.vertex) - link.foot(places.mesh, places.fitted);
      const Vector3 turn = rotations.vector(link.face);
      const Vector3 arm =
          rotation_of(t * turn) * ((1 - t) * before + t * (rotation_of(turn).transpose() * after));
      sum += link.foot(places.mesh, x) + arm - x.col(link.vertex);
    }
    return sum / static_cast<double>(of_piece.size());
  }

  Points source;
  Points fitted;
  Places places;
  FaceGradients gradients;
  std::vector<SurfacePiece> pieces;
  std::vector<std::vector<PieceLink>> links;
  FaceRotations rotations;
  EdgePoisson poisson;
  Points start, end;  // placed(0) and placed(1): the source and the fitted source except for rounding, faces
                      // without area and vertices that part
};

SurfacePath::SurfacePath(const TriangleMesh& source, const Points& fitted) {
  require_usable(source, fitted);
  parts_ = std::make_unique<const Parts>(source, fitted);
}

SurfacePath::~SurfacePath() = default;
SurfacePath::SurfacePath(SurfacePath&&) noexcept = default;

Points SurfacePath::at(double t) const {
  if (!(t >= 0 && t <= 1))
    throw InvalidInput("surface path at t = " + std::to_string(t) + ": t must lie in [0, 1]");
  if (t == 0) return parts_->source;
  if (t == 1) return parts_->fitted;
  const Points between = parts_->placed(t);
  const std::vector<int>& place = parts_->places.of_vertex;
  const Points away = between - (1 - t) * parts_->start - t * parts_->end;
  return (1 - t) * parts_->source + t * parts_->fitted + away(Eigen::all, place);
}

RegionalMotion SurfacePath::motion() const {
  RegionalMotion motion;
  const FaceRotations& rotations = parts_->rotations;
  const auto for_each = [&](const auto& value, const auto& visit) {
    for_each_region(parts_->places.mesh, parts_->gradients.areas, value, visit);
  };
  for_each([&](Eigen::Index face) -> Matrix3 { return rotations.vector(face) * Eigen::RowVector3d::UnitX(); },
           [&](const Matrix3& mean) { motion.turn = std::max(motion.turn, mean.col(0).norm()); });
  motion.stretch = regional_motion(parts_->places.mesh, parts_->places.fitted).stretch;
  return motion;
}

}  // namespace bespoke
