#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "bespoke/asset/asset.h"

namespace bespoke {

/// Signed distances of n points, and what each may be off by, ≥ 0; mesh units.
struct UncertainDistances {
  std::vector<double> distance, uncertainty;
};

/// Signed distance of a model in a narrow band, as the file holds it: a look-up. Between nodes by cubic
/// convolution (Keys 1981) near the surface, where trilinear values are off by h²/8 times the curvature,
/// trilinear towards the edge of the band. Beyond the band it is ± band(). Queries are thread-safe.
class DistanceGrid {
 public:
  double band() const;        ///< largest amount that is stored, mesh units
  double voxel_size() const;  ///< mesh units
  /// p99 of the amount at the model's own surface, where the distance is 0, mesh units.
  double error() const;

  /// At the columns of x (3×n, mesh units, the model's own frame), positive outside. Parallel inside.
  std::vector<double> operator()(const Points& x) const;

  /// With how far the two interpolations differ there, where the cubic one counts and inside: what the value
  /// may be off by. Large where the model has features as small as a voxel.
  UncertainDistances with_uncertainty(const Points& x) const;

  /// Whether both tell the same everywhere.
  friend bool operator==(const DistanceGrid& a, const DistanceGrid& b);

 private:
  friend class StoredDistances;
  struct Data;
  explicit DistanceGrid(std::shared_ptr<const Data> data) : data_(std::move(data)) {}
  std::shared_ptr<const Data> data_;
};

/// Of both models of a map.
struct ModelDistances {
  DistanceGrid source;  ///< source frame
  DistanceGrid target;  ///< target frame, at t = 1
};

/// Signed distances at points (3×n), positive outside, mesh units.
using SignedDistances = std::function<std::vector<double>(const Points&)>;

/// A model and its side, by a rule that the caller chooses.
struct SidedModel {
  const TriangleMesh& mesh;
  SignedDistances distance;
};

/// Adds the grid `target_distance` and, of an open source, `source_side`, to an asset that has its previews.
/// Throws InvalidInput without previews.
Asset with_model_distances(Asset asset, const SidedModel& source, const SidedModel& target);

/// What is known of the models of a map made of other maps: the distances of `source_of`'s source (its
/// target, where `turned`) and of `target_of`'s target (its source). The asset as it is where they lack
/// them.
Asset with_model_distances_of(Asset asset, const Asset& source_of, const Asset& target_of, bool turned);

/// Null for an asset without them: a map of before the grid was stored.
std::shared_ptr<const ModelDistances> model_distances(const Asset& asset);

}  // namespace bespoke
