#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bespoke/anchor_checks/contradicting_anchors.h"
#include "bespoke/anchor_checks/missed_anchors.h"
#include "bespoke/anchors/anchor_accuracy.h"
#include "bespoke/anchors/anchor_audit.h"
#include "bespoke/bake/bake.h"
#include "bespoke/cloud/point_cloud_surface.h"
#include "bespoke/elastic/elastic_methods.h"
#include "bespoke/flow/regional_motion.h"
#include "bespoke/quality/uncovered_area.h"
#include "bespoke/registration/fit_unanchored.h"
#include "bespoke/registration/registered_parts.h"
#include "bespoke/registration/stretched_edges.h"
#include "bespoke/registration/unmet_vertices.h"
#include "bespoke/rigid/rigid_transform.h"
#include "bespoke/statistics.h"
#include "bespoke/surface_fit/contact.h"
#include "bespoke/surface_fit/surface_fit.h"

namespace bespoke {

struct RigidSummary {
  bool by_vertices = false;  ///< pairs of vertices, without enough anchors
  double rotation = 0;       ///< radians, 0 … π
  /// Of models in two units (size_ratio.h), how many target units a source unit is: the residuals are then
  /// those of the similarity of least squares.
  std::optional<double> scale;
  Statistics residuals;  ///< |Γ(q) − q'|, mesh units of the target
  double seconds = 0;
};

/// All but `by_vertices` and `seconds`. Pairs 3×k, in their own frames, of which two differ.
RigidSummary rigid_summary(const RigidTransform& target_from_source, const Points& sources,
                           const Points& targets);

struct CoarseSummary {
  Statistics residuals;  ///< of the anchors after the warp, mesh units
  /// The anchors' spread does not determine an affine map: the warp's is drawn towards a similarity
  /// (regularised_alignment.h).
  bool regularised = false;
  bool turned_by_surfaces = false;          ///< about a line near which the anchors lie (anchor_start.h)
  Vector3 anchor_widths = Vector3::Zero();  ///< standard deviations, the largest first, mesh units
  AnchorAudit audit;
  std::vector<ContradictingAnchors> contradicting;
  double seconds = 0;
};

/// Places far from all anchors, by distances along the surfaces (geodesic_counterparts.h).
struct CounterpartSummary {
  std::size_t found = 0;
  std::size_t displaced = 0;  ///< of them, where the source came to lie elsewhere by the anchors alone
  bool taken = false;         ///< the source registered by them too explains the target better
  double seconds = 0;
};

struct ElasticSummary {
  ElasticMethod method = ElasticMethod::diffeomorphic;
  ElasticFindings found;                     ///< what the method says itself (of a chain's first step)
  std::vector<ElasticFindings> later_steps;  ///< of a chain, what it says of the others
  RegionalMotion motion;                     ///< of the fitted source: what the number of steps follows from
  bool divided_where_missed = false;         ///< more steps than the motion requires, to meet the vertices
  std::size_t divided_steps = 0;   ///< folded when baked or were foreseen to, so that there are more
  double lambda = 0;               ///< effective distance, mesh units
  bool left_guides = false;        ///< the surface, or the bake's tolerance, is met without
  Statistics vertex_residuals;     ///< |E(vᵢ) − v'ᵢ|, mesh units
  Statistics anchor_residuals;     ///< |Γ(E(q)) − q'|, mesh units
  std::vector<UnmetVertex> unmet;  ///< beyond a fit tolerance above 0; none requested at 0
  std::size_t unreferenced_vertices = 0;
  std::size_t duplicate_vertices = 0;
  std::size_t anchors_off_surface = 0;    ///< exact ones, beyond the fit tolerance from the source
  bool meets_anchors_off_surface = true;  ///< p-FFD does not: it knows faces only
  double seconds = 0;
};

/// How well the map takes a curve of the source onto its counterpart.
struct CurveSummary {
  std::string name;
  double largest_distance = 0;  ///< of places along the mapped curve from the target's, mesh units
};

/// What became of a patch.
struct PatchSummary {
  std::string name;
  bool exclude = false;
  std::size_t source_faces = 0;
  std::size_t target_faces = 0;
  /// Of places along its mapped border from the target's, mesh units; empty without border or map.
  std::optional<double> largest_distance;
};

/// Vertices that were joined along seams for the surface fitting (seams.h).
struct SeamSummary {
  std::size_t source = 0, target = 0;
};
inline bool has_any(const SeamSummary& summary) { return summary.source + summary.target > 0; }

/// What the registration of the source found.
struct RegistrationSummary {
  SeamSummary seams;
  std::optional<LoosePartsSummary> parts;  ///< empty where all parts of the source are registered
  /// Of a dense source, those that were registered: what is said of the surface fit is said of them, and the
  /// others follow (decimated_source.h). 0 where all were.
  std::size_t leading_vertices = 0;
  std::optional<UnanchoredSummary> unanchored;  ///< empty with anchors or a given fitted source
  AnchorAccuracy accuracy;                      ///< of anchors that came without
  std::string matched_parts;  ///< how disconnected parts correspond (matched_parts.h); mostly empty
  RigidSummary rigid;
  std::optional<CoarseSummary> coarse;             ///< empty when the fitted source was given, or no anchors
  std::optional<CounterpartSummary> counterparts;  ///< empty where nothing spoke against the anchors alone
  std::optional<SurfaceFitSummary> surface;        ///< empty when the fitted source was given
  SurfaceFitMethod surface_method = SurfaceFitMethod::deformation_graph;
  std::optional<UncoveredArea>
      uncovered;  ///< farther than 1 % of the target's diagonal; empty when the fitted source was given
  std::optional<ContactSummary> contact;  ///< empty where nothing touches
  std::vector<PatchSummary> patches;
};

/// What every stage of a fit found.
struct FitSummary : RegistrationSummary {
  std::optional<PointCloudSummary> cloud;  ///< the target's, if it was one
  std::vector<MissedAnchor> missed;        ///< by more than their accuracy explains
  StretchedEdges stretched;                ///< beyond SurfaceFitOptions::max_stretch
  ElasticSummary elastic;
  std::vector<CurveSummary> curves;
  std::optional<BakeSummary> bake;      ///< of the whole map; empty without make_map
  std::vector<BakeSummary> bake_steps;  ///< of a chain, one per step
};

/// One line each. Anchors: those of the fit, for their names.
std::string to_string(const SeamSummary& summary);
std::string to_string(const RigidSummary& summary);
std::string to_string(const CoarseSummary& summary, const Anchors& anchors);
std::string to_string(const CounterpartSummary& summary);
std::string to_string(const ElasticSummary& summary);
std::string to_string(const std::vector<CurveSummary>& curves);
std::string to_string(const std::vector<PatchSummary>& patches);

/// A stage that ran.
struct StageLine {
  std::string name;  ///< "cloud", "seams", "parts", "alignment", "accuracy", "rigid", "coarse",
                     ///< "counterparts", "surface-fit", "uncovered", "contact", "elastic", "curves",
                     ///< "patches", "bake"
  std::string line;
};

/// In their order; "cloud" for a target that was one, "seams" for models that have some, "parts" for a source
/// with loose ones, "alignment" without anchors only, "accuracy", "counterparts" and "uncovered" only where
/// they found something.
std::vector<StageLine> stage_lines(const FitSummary& summary, const Anchors& anchors);

}  // namespace bespoke
