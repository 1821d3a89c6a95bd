#pragma once

#include <memory>
#include <vector>

#include "bespoke/clearance/clear_products.h"

namespace bespoke {

/// A map as clearance needs it, whichever way it leads.
struct ClearanceMap {
  std::shared_ptr<const ElasticMap> elastic;
  RigidTransform target_from_source;
  std::shared_ptr<const ModelDistances> distances;  ///< of the models; null where the map's file lacks them
  ModelSizes sizes;
};

/// Keeps products clear of a map's target and, where they are layers, of those before them: in the order of
/// the calls, from the inside to the outside.
class ProductClearer {
 public:
  enum class Products { alone, layers };

  ProductClearer(const ClearanceRule& rule, Products products) : rule_(rule), products_(products) {}

  /// The map that takes the product where it is clear. All maps of one clearer lead to one target. Throws
  /// InvalidInput for maps without distances.
  std::shared_ptr<const ElasticMap> corrected(WornProduct product, const ClearanceMap& map);

  /// Of the products so far, one each.
  const std::vector<ProductClearance>& found() const { return found_; }

 private:
  struct Layer {
    WornProduct product;
    Points after;
  };

  ClearanceRule rule_;
  Products products_;
  std::vector<Layer> layers_;
  std::vector<ProductClearance> found_;
};

}  // namespace bespoke
