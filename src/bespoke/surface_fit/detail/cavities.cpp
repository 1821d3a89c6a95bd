#include "bespoke/surface_fit/detail/cavities.h"

#include <Eigen/LU>

#include "bespoke/mesh/box_tree.h"
#include "bespoke/parallel.h"
#include "bespoke/surface_fit/detail/reciprocity.h"

namespace bespoke {
namespace {

/// Whether the way straight out of a surface, over `reach` (mesh units), soon meets the same surface again.
class Facing {
 public:
  Facing(const TargetSurface& surface, double reach)
      : mesh_(surface.mesh()), tree_(build_box_tree(face_boxes(surface.mesh()))), reach_(reach) {}

  bool operator()(const Vector3& x, const Vector3& normal) const {
    for (int piece = 0; piece < pieces; ++piece) {
      const Vector3 from = x + (piece * reach_ / pieces) * normal;
      const Vector3 to = x + ((piece + 1) * reach_ / pieces) * normal;
      bool met = false;
      Box box(from.cwiseMin(to), from.cwiseMax(to));
      for_each_overlapping(tree_, box, [&](int face) { met = met || meets(face, x, normal); });
      if (met) return true;
    }
    return false;
  }

 private:
  static constexpr int pieces = 8;          // boxes of shorter pieces meet fewer faces
  static constexpr double rounding = 1e-9;  // of barycentric weights: a ray through an edge meets a face
  static constexpr double least = 1e-9;     // of the reach: what lies at x itself is not before it

  /// Front sides only: the back of a face means that x lies inside.
  bool meets(int face, const Vector3& x, const Vector3& direction) const {
    const auto corner = [&](int k) -> Vector3 { return mesh_.vertices.col(mesh_.faces(k, face)); };
    Matrix3 system;
    system << corner(1) - corner(0), corner(2) - corner(0), -direction;
    if (!(system.col(0).cross(system.col(1)).dot(direction) < 0)) return false;
    const Vector3 solution = system.partialPivLu().solve(x - corner(0));
    return solution[0] >= -rounding && solution[1] >= -rounding &&
           solution[0] + solution[1] <= 1 + rounding && solution[2] > least * reach_ && solution[2] <= reach_;
  }

  const TriangleMesh& mesh_;
  BoxTree tree_;
  double reach_;
};

}  // namespace

std::vector<char> vertices_in_lacking_cavities(const TargetSurface& source, const TargetSurface& target,
                                               double diagonal, const CavitySettings& settings) {
  const MatchLimits limits{settings.min_cosine, settings.reach * diagonal};
  const Facing faces_source(source, limits.max_distance), faces_target(target, limits.max_distance);
  const Points& vertices = source.mesh().vertices;
  std::vector<char> hidden(static_cast<std::size_t>(vertices.cols()), 0);
  constexpr std::size_t grain = 128;
  parallel_for(hidden.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Vector3 x = vertices.col(static_cast<Eigen::Index>(k));
      const Vector3 normal = source.normals().col(static_cast<Eigen::Index>(k));
      const auto counterpart = target.match(x, normal, limits);
      if (!counterpart || !faces_source(x, normal) || faces_target(counterpart->point, counterpart->normal))
        continue;
      const auto claim = nearer_claim({x, *counterpart, limits}, source, settings.much_nearer);
      hidden[k] = claim && !faces_source(claim->point, claim->normal);
    }
  });
  return hidden;
}

}  // namespace bespoke
