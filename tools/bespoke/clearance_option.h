#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/clearance/nesting.h"
#include "bespoke/clearance/product_clearer.h"
#include "bespoke/pipeline/open_map.h"
#include "run_options.h"

namespace bespoke::command {

struct ClearanceOption {
  std::string distance = "off";  ///< keep, same, off, or a length
  bool require_clear = false;
  bool layers = false;

  bool is_used() const { return distance != "off"; }
};

inline constexpr const char* clearance_help =
    "What carried products keep from the target: keep (each place at least as far outside as it was from the "
    "source), same (and, within 2 % of the source, hardly farther), a length (mesh units or % of the "
    "source's diagonal), or off. What misses that is moved, as "
    "little and as smoothly as it can be; the map must hold the distances of its models";
inline constexpr const char* require_clear_help =
    "Exit with code 3 if a product is not clear although it was corrected; it is written all the same";

/// Adds --clearance and --layers.
void add_clearance_options(CLI::App& app, ClearanceOption& option);

/// Adds --require-clear.
void add_require_clear(CLI::App& app, ClearanceOption& option);

/// Throws CLI::ValidationError for a distance that is none, and for what needs one.
void require_valid(const ClearanceOption& option);

/// Parts that keep their shape, by the name of the product that has them.
using PartsOfProducts = std::map<std::string, std::vector<RigidPart>>;

/// Those of the product, or none.
std::vector<RigidPart> parts_of(const PartsOfProducts& parts, const std::string& product);

/// Keeps the products of a run clear, in the order of the calls.
class ClearanceKeeper {
 public:
  /// `unit`: of the products' coordinates, as product_scale takes it; `pose`: of skinned products.
  ClearanceKeeper(ClearanceOption option, PartsOfProducts parts, std::string unit,
                  ModelPose pose = ModelPose::shown)
      : option_(std::move(option)), parts_(std::move(parts)), unit_(std::move(unit)), pose_(pose) {}

  /// The order in which they are to be corrected, numbers of the list: of the call where they are named as
  /// layers, else as they lie over each other on the source.
  std::vector<std::size_t> order(const std::vector<std::string>& products, const OpenedMap& map);

  /// The map that takes the product where it is clear; the map itself where clearance is off. Throws
  /// InvalidInput for maps without distances and products without places that can be read.
  OpenedMap corrected(const std::string& product, const OpenedMap& map);

  /// Where `apply` takes the vertices of the product by that map (3×n, target frame).
  Points carried(const std::string& product, const OpenedMap& map) const;

  /// Of the last product; nothing where clearance is off.
  std::optional<ProductClearance> last() const;

  /// Nothing where a single product, or none, is kept clear.
  const std::optional<LayerOrder>& layer_order() const { return layer_order_; }

  /// Throws SolverError, naming them, where products are not clear and must be.
  void require_clear() const;

 private:
  ClearanceOption option_;
  WornProduct worn(const std::string& product, const std::string& map_unit) const;

  PartsOfProducts parts_;
  std::string unit_;
  ModelPose pose_;
  bool are_layers_ = false;
  std::optional<LayerOrder> layer_order_;
  std::optional<ProductClearer> clearer_;
};

/// "layers, from the inside to the outside: shirt.obj, jacket.obj (found on the source; …)".
std::string to_string(const LayerOrder& order);

/// Warns where no order is right, and where the one found is that of the call.
void warn_of_layers(const RunContext& context, const LayerOrder& order);

/// "not clear, although it was corrected: 12 samples are inside or short of their distance, the worst around
/// (…)".
std::string what_is_not_clear(const ClearanceSummary& summary);

/// Every line after "OUT: ".
void print_clearance(const std::string& output, const ProductClearance& clearance);

}  // namespace bespoke::command
