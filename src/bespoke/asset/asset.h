#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bespoke/certificate/certificate.h"
#include "bespoke/lattice/pyramid.h"
#include "bespoke/mapping/elastic_chain.h"
#include "bespoke/mapping/mapping.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/statistics.h"

namespace bespoke {

/// One of the two models that a map joins, without its geometry.
struct ModelRecord {
  std::string hash;  ///< content_hash of the mesh, or of the point cloud
  Box box;           ///< mesh units, own frame
};

struct AnchorRecord {
  std::string name;
  Vector3 a;            ///< mesh units
  Vector3 b;            ///< mesh units
  double weight = 0;    ///< infinite = exact
  double residual = 0;  ///< |Ψ(1)(a) − b|, mesh units
  double sigma = 0;  ///< accuracy that the fit took the pair to have, mesh units; 0 where the weight says it
};

/// What an asset says about its map besides the map itself. No clock, no path, no user.
struct AssetRecord {
  std::string unit;                ///< of all lengths, "unknown" when not given
  std::string elastic_method;      ///< for instance "csrbf"
  std::string surface_fit_method;  ///< for instance "laplacian", "given"
  double lambda = 0;               ///< effective distance, mesh units
  double tolerance = 0;            ///< requested, mesh units
  Statistics bake_error;           ///< measured, mesh units
  std::string options_json;        ///< an object: every option that shaped the map
  std::string stages_json;         ///< an array: what each stage found, without times
  std::vector<AnchorRecord> anchors;
  ModelRecord source;
  ModelRecord target;
};

/// The grids that only other programs read: displacement, source_distance, jacobian. Made by with_preview,
/// kept as they are from reading to writing.
class PreviewGrids;

/// One step of a map: a₀, A, u, and what is proved about them.
struct MapStep {
  AffineMap affine;         ///< a₀, A
  Pyramid pyramid;          ///< u
  Certificate certificate;  ///< of t = 1, as found when the asset was made
};

/// A map as a file holds it: version 1 with one step, version 2 with several (src/bespoke/README.md, "The
/// file").
struct Asset {
  RigidTransform target_from_source;  ///< Γ
  RotationPath path = RotationPath::geodesic;
  std::vector<MapStep> steps = std::vector<MapStep>(1);  ///< E = E_K ∘ … ∘ E_1, all in the source frame
  AssetRecord record;
  std::string
      exact_map;  ///< bytes of the exact E (`--keep-exact`), empty without; the asset does not read them
  std::shared_ptr<const PreviewGrids> preview;
};

/// E as stored, without further copies of the steps' pyramids.
ElasticChain baked_chain(std::vector<MapStep> steps);

/// The same for carrying products: every step in its fastest form (loaded_map), which rounds sums to floats.
ElasticChain loaded_chain(std::vector<MapStep> steps);

/// Of the whole: counts add up, determinants (lower bounds, where certified) multiply, and places follow one
/// another, each in the frame of its own step. A bijection exactly when every step is one.
Certificate whole_certificate(const Asset& asset);

std::size_t voxel_count(const Asset& asset);

/// Throws InvalidInput, naming what is wrong, unless there is a step, R is a rotation, every number is finite
/// and within its range, the boxes are not empty, the pyramids are valid and of one precision, and no
/// certificate of bijection contradicts its step.
void require_valid(const Asset& asset);

/// Adds the preview grids for `source` (the reference model, source frame) to everything else that `asset`
/// already holds. Throws InvalidInput.
Asset with_preview(Asset asset, const TriangleMesh& source);

/// The same for an asset without its source at hand: `original` is an asset whose source's image under its
/// map is the source of this one, or, with `map_back` empty, whose source is. Throws InvalidInput when it has
/// no preview.
Asset with_preview_of(Asset asset, const Asset& original,
                      const std::function<Points(const Points&)>& map_back = {});

}  // namespace bespoke
