#include "corrected_products.h"

namespace bespoke::command {

CorrectedProducts corrected_products(const ProductsAsWorn& worn, const std::vector<NamedProduct>& products,
                                     const OpenedMap& map) {
  CorrectedProducts corrected;
  if (worn.is_as_mapped()) return corrected;
  ClearanceKeeper keeper(worn.clearance, worn.parts, worn.unit, worn.pose_or_shown());
  corrected.places.resize(products.size());
  if (worn.clearance.is_used()) corrected.found.resize(products.size());
  for (const std::size_t i : keeper.order(worn.files, map)) {
    const OpenedMap own = keeper.corrected(worn.files[i], map);
    corrected.places[i] = worn.parts.empty()
                              ? own.target_from_source * (*own.elastic)(products[i].mesh.vertices)
                              : keeper.carried(worn.files[i], own);
    if (worn.clearance.is_used()) corrected.found[i] = *keeper.last();
  }
  corrected.order = keeper.layer_order();
  return corrected;
}

}  // namespace bespoke::command
