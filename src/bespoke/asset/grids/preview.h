#pragma once

#include <functional>
#include <vector>

#include "bespoke/asset/asset.h"
#include "bespoke/asset/grids/stored_grid.h"
#include "bespoke/mapping/elastic_chain.h"

namespace bespoke {

inline constexpr const char* displacement_name = "displacement";
inline constexpr const char* source_distance_name = "source_distance";
inline constexpr const char* jacobian_name = "jacobian";
inline constexpr const char* target_distance_name = "target_distance";
inline constexpr const char* source_side_name = "source_side";

/// The grids of an asset that carry no map: displacement, source_distance, jacobian, which other programs
/// show, and, of maps that have them, target_distance and source_side (model_distances.h).
class PreviewGrids {
 public:
  static constexpr std::size_t required = 3;

  /// Throws InvalidInput unless these are the three, followed by none, the first or both of the others, in
  /// this order, of their types.
  explicit PreviewGrids(std::vector<StoredGrid> grids);

  const std::vector<StoredGrid>& grids() const { return grids_; }

 private:
  std::vector<StoredGrid> grids_;
};

/// Ψ(1)(x) − x on one lattice over the source's box, grown by λ, and over all leaves of the pyramids; about
/// 64 nodes along its longest side. Its error, measured at the centres of its cells, is in its metadata.
/// `baked` is the asset's E.
StoredGrid displacement_preview(const Asset& asset, const ElasticChain& baked, const Box& source_box);

/// On the displacement preview's lattice: with one step the lower bound, minus 1, of det ∇E over the cells
/// that touch the node; with several, whose cells do not coincide, det ∇E − 1 at the node itself.
StoredGrid jacobian_preview(const ElasticChain& baked, const StoredGrid& displacement);

/// The source as a level set about 128 voxels long: of the signed distance where the mesh has no boundary;
/// otherwise of a shell, the unsigned distance minus one voxel. Its metadata says which.
StoredGrid source_distance_preview(const TriangleMesh& source);

/// The surface of `distance` mapped by a map whose inverse is `map_back`, about 128 voxels along the
/// diagonal of `box` (which holds its image): a shell as of an open mesh, of the distance before the map.
StoredGrid carried_distance(const StoredGrid& distance, const Box& box,
                            const std::function<Points(const Points&)>& map_back);

}  // namespace bespoke
