#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/topology/decimation.h"

namespace bespoke {

/// A dense mesh by some of its vertices, which the others follow: what a registration finds at the spacing of
/// its finest layers needs no more.
class DecimatedSource {
 public:
  /// Of at most `max_faces` triangles (decimated()). Refers to `whole`, which must be usable (require_valid).
  DecimatedSource(const TriangleMesh& whole, std::size_t max_faces);

  const TriangleMesh& mesh() const { return decimated_.mesh; }
  /// For every vertex of mesh() its number in the whole.
  const std::vector<int>& vertices() const { return decimated_.vertices; }

  /// 3×n, for the whole's vertices, when those of mesh() are at `moved` (3×m): a vertex x goes with the face
  /// that it lies nearest to, whose corners go from pₖ to qₖ. With its foot f = Σ bₖ pₖ there,
  ///
  ///     φ(x) = Σ bₖ (qₖ + Fₖ ((f − pₖ) / 2 + x − f)),
  ///
  /// where Fₖ is the linear map nearest to what moved the edges and the normals around corner k. Halves, as
  /// corners and gradients interpolate with opposite errors. A similarity of mesh() moves all alike.
  Points followed(const Points& moved) const;
  /// Of the whole's vertices those that go with a face at one of these vertices of mesh(), ascending.
  std::vector<int> followers(const std::vector<int>& leading) const;
  /// n: a value of every vertex of mesh() (m), interpolated in the faces.
  std::vector<double> interpolated(const std::vector<double>& values) const;

 private:
  struct Foot {
    int face;
    Vector3 barycentric;
  };

  const TriangleMesh& whole_;
  DecimatedMesh decimated_;
  std::vector<Foot> feet_;  // n
};

}  // namespace bespoke
