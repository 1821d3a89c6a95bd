#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <variant>

#include "bespoke/elastic/csrbf.h"
#include "bespoke/elastic/elastic_fit.h"
#include "bespoke/elastic/elastic_method.h"
#include "bespoke/elastic/finite_elements.h"
#include "bespoke/elastic/multiscale.h"
#include "bespoke/elastic/pffd.h"
#include "bespoke/elastic/pffd_smooth.h"

namespace bespoke {

/// What the method found; each has to_string and figures.
using ElasticFindings = std::variant<FiniteElementSummary, CsrbfSummary, MultiscaleSummary, PffdSummary>;

struct ElasticFit {
  std::shared_ptr<const ElasticMap> map;
  ElasticFindings found;
};

/// How a class of maps is kept (exact_map_io.h).
struct StoredMapType {
  std::uint32_t number;  ///< in the bytes; never used again for another class
  bool (*holds)(const ElasticMap& map);
  void (*write)(const ElasticMap& map, ExactMapWriter& writer);
  std::shared_ptr<const ElasticMap> (*read)(ExactMapReader& reader);
};

/// How maps that are compositions of others come apart; null for methods whose maps are none.
struct CompositionOfMaps {
  std::size_t (*parts)(const ElasticMap& map) = nullptr;
  /// Of how many different sizes the parts of a map are; some are of one size where motion is too steep for
  /// one of them.
  std::size_t (*scales)(const ElasticMap& map) = nullptr;
  /// Of a map of two parts or more: the same map as two, one after the other.
  std::array<ElasticFit, 2> (*halves)(const ElasticFit& fit) = nullptr;

  explicit operator bool() const { return parts != nullptr; }
};

/// All that is known of a method elsewhere: the command line, the asset's record and the exact map's bytes
/// go through this table.
struct ElasticMethodRow {
  std::string_view name;
  ElasticMethod value;
  ElasticFit (*fit)(const ElasticInput& input, const ElasticOptions& options, const Progress& progress);
  /// Whether it meets points that are no vertices: ElasticInput::sources may hold any others.
  bool meets_points;
  /// Whether its maps fold nowhere, so that a bake's folds are those of its voxels.
  bool keeps_orientation;
  bool takes_guides;  ///< in space, beside the surface
  /// Whether it weighs guides against distortion, so that none need be left out where they harm.
  bool weighs_guides;
  /// In fit tolerances: vertices missed by more are listed. A least-squares fit refines where the tolerance
  /// is missed and leaves what costs too much distortion.
  double met_within;
  /// Steps of a chain for each that the motion requires. More than one where a minimiser is held up in large
  /// ones; these are then halved (elastic_steps.h).
  int steps_per_required;
  CompositionOfMaps composition;
  StoredMapType stored;
};

extern const std::array<ElasticMethodRow, 6> elastic_methods;

/// Throws InvalidInput for a value without a row.
const ElasticMethodRow& elastic_method(ElasticMethod method);

}  // namespace bespoke
