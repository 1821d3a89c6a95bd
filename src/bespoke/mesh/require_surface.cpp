#include "bespoke/mesh/require_surface.h"

#include "bespoke/error.h"

namespace bespoke {

void require_surface(const TriangleMesh& mesh, const std::string& what) {
  require_valid(mesh, what);
  if (face_normals(mesh).isZero(0)) throw InvalidInput(what + " has no area: its faces are lines or points");
}

}  // namespace bespoke
