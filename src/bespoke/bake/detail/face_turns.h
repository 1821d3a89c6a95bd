#pragma once

#include <vector>

#include "bespoke/bake/bake.h"
#include "bespoke/lattice/pyramid.h"
#include "bespoke/mapping/elastic_map.h"
#include "bespoke/types.h"

namespace bespoke {

/// How pyramids turn the faces of BakeOptions::surface against the map itself. An error within the tolerance
/// turns a face that is hardly longer, in the corner of a mouth say, by any angle.
class FaceTurns {
 public:
  /// `thinnest`: faces of less height on the surface are passed over, mesh units; the smallest voxel's size,
  /// since what is thinner no voxel resolves. Map and options must outlive it.
  FaceTurns(const ElasticMap& map, const BakeOptions& options, double thinnest);

  /// Faces that the pyramid turns by more than BakeOptions::max_face_turn, the farthest first; moves it in
  /// and out.
  std::vector<Eigen::Index> misoriented_faces(Pyramid& pyramid) const;

  /// Corners and middles of faces, 3×4k, mesh units.
  Points places(const std::vector<Eigen::Index>& faces) const;

 private:
  Points normals(const ElasticMap& map) const;

  const ElasticMap& map_;
  const BakeOptions& options_;
  std::vector<Eigen::Index> faces_;  // those that are looked at
  Points normals_;                   // 3×k, where the map takes these
};

}  // namespace bespoke
