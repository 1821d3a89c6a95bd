#include "bespoke/page/carried_picture.h"

#include "bespoke/apply/apply_mapping.h"
#include "bespoke/page/detail/picture.h"

namespace bespoke {

std::string carried_picture(const CarriedScene& scene, int size) {
  const Vector3 model_colour(0.62, 0.70, 0.78), product_colour(0.80, 0.52, 0.36);
  // Without the rigid motion, so that the front of the source is that of the picture.
  const ImageOfPoints carried = image_at(scene.elastic, RigidTransform{}, scene.t, scene.motion);
  std::vector<PaintedMesh> meshes;
  if (scene.t == 1)
    meshes.push_back(
        {inverse(scene.target_from_source) * scene.target.vertices, scene.target.faces, {model_colour}});
  else
    meshes.push_back({carried(scene.source.vertices), scene.source.faces, {model_colour}});
  for (std::size_t i = 0; i < scene.products.size(); ++i) {
    const TriangleMesh& product = scene.products[i];
    if (product.faces.cols() == 0) continue;
    const Points places = scene.cleared.empty() ? carried(product.vertices)
                                                : inverse(scene.target_from_source) * scene.cleared[i];
    meshes.push_back({places, product.faces, {product_colour}});
  }
  return png(draw(meshes, DrawnFrom::front, size));
}

}  // namespace bespoke
