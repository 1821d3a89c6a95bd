#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/apply/apply_to_product.h"
#include "bespoke/clearance/clear_products.h"
#include "bespoke/clearance/nesting.h"
#include "bespoke/pipeline/make_map.h"

namespace bespoke {

/// Largest resident memory of this process so far, bytes.
std::size_t peak_memory();

/// How a map came to be, as a JSON object: models, options, per stage its residuals, iterations, stop reason
/// and seconds, counts, peak memory.
std::string fit_report(const Problem& input, const MadeMap& made, double seconds);

struct AppliedProduct {
  std::string name;  ///< of the file, without its directory
  ProductSummary summary;
  std::optional<ProductClearance> clearance = {};  ///< where it was kept
};

/// What was applied at which times, as a JSON object. `layers`: of products that were kept from each other.
std::string apply_report(const std::vector<AppliedProduct>& products, const std::vector<double>& times,
                         double seconds, const std::optional<LayerOrder>& layers = std::nullopt);

}  // namespace bespoke
