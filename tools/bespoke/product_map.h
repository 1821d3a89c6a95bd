#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bespoke/pipeline/open_map.h"
#include "planned_run.h"

namespace bespoke::command {

/// How a map is opened for products.
struct ProductMapOptions {
  MapForm form = MapForm::grids;
  bool untrusted = false;
  /// Whether points are queried where the product has none of its own, between 0 and 1.
  bool moves_points = false;
  std::string unit;                   ///< of the products' coordinates, where it is given (product_scale)
  ModelPose pose = ModelPose::shown;  ///< of skinned products
};

/// The map that products go through. A run of its own reads what lies near them, where the file lets it, it
/// is much larger than they are, and their points are known beforehand; else the map is read as a whole, as
/// it is for all jobs of a batch.
class ProductMap {
 public:
  ProductMap(std::filesystem::path file, const std::vector<std::string>& products,
             const ProductMapOptions& options, const RunContext& context);

  /// Calls `apply` with the map; again with the whole, after a warning, where it queried more than the
  /// part.
  void use(const std::string& product, const std::function<void(const OpenedMap&)>& apply);

  /// "map.vdb: 12.3 of 1024.0 MB read", or nothing where all was.
  std::string reading() const;

 private:
  void open_whole();

  std::filesystem::path file_;
  ProductMapOptions options_;
  const RunContext& context_;
  std::shared_ptr<const OpenedMap> map_;
  std::uint64_t bytes_read_ = 0, file_bytes_ = 0;  // 0 where all was read
};

}  // namespace bespoke::command
