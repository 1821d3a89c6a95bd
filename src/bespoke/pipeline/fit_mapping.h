#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/anchors/anchors.h"
#include "bespoke/mapping/elastic_map.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/pipeline/unmet_vertices.h"
#include "bespoke/progress.h"
#include "bespoke/rigid/rigid_transform.h"
#include "bespoke/surface_fit/surface_fit.h"

namespace bespoke {

enum class ElasticMethod {
  csrbf,          ///< the paper's, one scale (Eq. 16)
  multiscale,     ///< residual correction over halved scales
  diffeomorphic,  ///< the same layers composed, each a diffeomorphism
  pffd,           ///< the paper's p-FFD (Eq. 18)
};

struct FitOptions {
  SurfaceFitOptions surface_fit;
  ElasticMethod elastic = ElasticMethod::diffeomorphic;
  double lambda = 0;  ///< effective distance, > 0, mesh units
  double fit_tolerance =
      0;  ///< the multiscale methods stop refining below it, ≥ 0, mesh units; csrbf interpolates
  std::size_t max_memory = std::size_t{8} << 30;  ///< bytes
};

/// What a stage of the fit did, as lines for a person and as JSON for a program.
struct StageReport {
  std::string name;  ///< "alignment", "rigid", "coarse", "surface-fit", "elastic"
  std::string line;  ///< one line
  std::string json;  ///< an object; without times, so that it may enter an asset
  double seconds = 0;
};

/// Everything the fit found; Ψ = Γ∘E.
struct FittedMapping {
  RigidTransform target_from_source;          ///< Γ
  std::shared_ptr<const ElasticMap> elastic;  ///< E
  Points fitted_vertices;                     ///< H'_a, 3×n, source frame, mesh units
  std::vector<double> confidence;             ///< of the surface fitting, n (surface_fit.h); empty without
  Statistics anchor_residuals;                ///< |Γ(E(q)) − q'|, mesh units
  std::vector<double> anchor_residual;        ///< the same, one per pair
  Statistics vertex_residuals;                ///< |E(vᵢ) − v'ᵢ|, mesh units
  std::vector<UnmetVertex> unmet;             ///< beyond a fit tolerance above 0; none asked for at 0
  std::vector<StageReport> stages;
};

/// The whole way of section IV: rigid part, coarse warp, surface fitting, elastic map. Without anchors the
/// surfaces alone are aligned (align_models.h), for models in similar pose: the stage "alignment" says how
/// sure that is. Throws InvalidInput, SolverError (also when the alignment is not certain), MemoryLimitError.
FittedMapping fit_mapping(const TriangleMesh& source, const TriangleMesh& target, const Anchors& anchors,
                          const FitOptions& options, const Progress& progress = {});

/// The same for a source that somebody already fitted: `fitted` has the source's connectivity and lies on the
/// target, in the target frame (the consistent-connectivity case of the paper's references 4–7). Anchors may
/// be empty: then all vertices serve as anchors of the rigid part.
FittedMapping fit_mapping_to_fitted(const TriangleMesh& source, const TriangleMesh& fitted,
                                    const Anchors& anchors, const FitOptions& options,
                                    const Progress& progress = {});

}  // namespace bespoke
