#include "bespoke/page/source_thumbnail.h"

#include "bespoke/asset/source_surface.h"
#include "bespoke/base64.h"
#include "bespoke/page/detail/picture.h"

namespace bespoke {

std::string source_thumbnail(const Asset& asset, int size) {
  const Vector3 clay(0.78, 0.74, 0.70);
  const TriangleMesh surface = source_surface(asset);
  return "data:image/png;base64," +
         base64(png(draw({{surface.vertices, surface.faces, {clay}}}, DrawnFrom::front, size)));
}

}  // namespace bespoke
