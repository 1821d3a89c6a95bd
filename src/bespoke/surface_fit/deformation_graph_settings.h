#pragma once

#include <array>
#include <cstddef>

#include "bespoke/rbf/layer_solver.h"

namespace bespoke {

// Every tuned constant of the default surface fit, one struct for each stage. "Diagonal" is that of the
// bounding box of the aligned source; models are fitted at a size where it is 1. The experiments behind the
// values: tests/accuracy/tuning.md.

/// One similarity for the whole source (similarity_fit.h), by iteratively reweighted least squares.
struct SimilaritySettings {
  /// Diagonals: a similarity with smaller plane residuals explains the target. Above the noise of remeshing.
  double tolerance = 5e-4;
  double anchor_tolerance = 2;  ///< tolerances: the largest residual of an exact anchor
  /// Largest correlation of residuals with the mean of some ten around them that is noise of the surfaces: of
  /// white noise it is 0, of relief that the vertices resolve about 1.
  double noise_correlation = 0.3;
  double max_noise = 3;  ///< tolerances: a larger residual is no noise, however the vertices see it
  /// Of the residuals, by area, that must be within the tolerance: holes and debris do not decide.
  double quantile = 0.9;
  int max_iterations = 12;       ///< Gauss-Newton steps
  int trial_iterations = 3;      ///< before the early exit
  double early_exit_factor = 8;  ///< tolerances: a larger residual after the trials ends the fit. Saves time.
  double max_distance = 0.05;    ///< diagonals, between counterparts
  double min_cosine = 0.5;       ///< between normals of counterparts: within 60 degrees
  double outlier_medians = 2;    ///< scale of the M-estimator, median residuals: weight 1/2 there
  double outlier_floor = 1e-12;  ///< of the largest distance: keeps the weights of an exact copy finite
  std::size_t max_samples = 4000;  ///< vertices queried: seven unknowns need few
};

/// Sample weights by curvature (informative_areas.h): bends fix the place along the surface, planes do not.
struct AreaSettings {
  double length = 0.01;    ///< ℓ, diagonals: bends of this radius count twice
  double max_weight = 4;   ///< added to 1 at most: bounds what noise in the normals contributes
  double shortest = 1e-4;  ///< diagonals: shorter edges count as this long; their normals are rounding
};

/// Nodes of an embedded deformation graph (Sumner 2007) and how vertices follow them (deformation_nodes.h).
struct NodeSettings {
  /// Nodes that a vertex follows: a planar neighbourhood of `follow_reach` has about as many.
  static constexpr int per_vertex = 8;

  double follow_reach = 2.6;     ///< spacings: the farthest node that a vertex follows
  double neighbour_reach = 2.3;  ///< spacings between linked nodes
  int min_neighbours = 8;        ///< fewer do not determine an affine map robustly
  /// Nodes × spacing² / area of a dense thinning: turns a count of nodes into a spacing.
  double packing = 0.75;
  /// Of the area. Where components large enough for nodes cover less, the mesh is a polygon soup and
  /// distances are those in space.
  double min_carried_area = 0.5;
  /// Of the farthest followed node's distance, where weights reach zero: a node fades before it is dropped.
  double fade_margin = 1.05;
  double weight_floor = 1e-9;  ///< of a weight: keeps the sum positive when all nodes lie at the reach
  /// Of the trace of the nodes' spread, added in all directions: nodes of a surface fix no slope across it.
  double flatness = 0.02;
  double spread_floor = 1e-3;  ///< squared spacings, added to the spread: a single node has none
};

/// Second differences of the nodes' displacements (deformation_nodes.h).
struct BendingSettings {
  double squared_width = 3;    ///< squared spacings: a neighbour's weight is exp(−r² / this)
  double weight_floor = 1e-2;  ///< couples distant components, where the exponential vanishes
  /// Added to a Gram matrix of order 1: fixes slopes across a flat neighbourhood, which no node determines.
  double slope_penalty = 1e-3;
  /// Bounds a local scale over the median one, either way. A node bends by its area at rest times the squared
  /// scale: a grown area counts as it is now, except where a pose grew it. What shrinks gets softer, which
  /// without a narrow bound lets parts without pairs shrink and drift away.
  double max_growth = 3;
};

/// How much the surface keeps its shape, node by node (node_system.h): an as-similar-as-possible term
/// (Sorkine & Alexa 2007; Igarashi 2005).
struct ShapeSettings {
  double share = 0.1;  ///< of ℓ: the length over which the term counts
  /// Of the logarithm of a local scale over the median one: how freely a part grows more than the others.
  double scale_freedom = 0.5;
  /// Strain after the first level (NodeSystem::median_strain). A pair with less is nearly rigid: the share
  /// grows by the ratio, and bending costs less.
  double usual_strain = 0.05;
  double max_rigid = 10;  ///< bounds that ratio, for exact copies
};

/// Which boundaries are the same cut (boundary_match.h).
struct BoundarySettings {
  double max_stretch = 0.5;  ///< of the strip between a boundary and the nearest anchor
  double must_agree = 0.9;   ///< of a boundary's vertices: notches do not decide
};

/// Anchors of limited accuracy (anchor_limits.h).
struct AnchorSettings {
  double along_surface = 0.001;  ///< τ, diagonals: uncertainty along surfaces that coincide
  double max_reinforced = 10;    ///< factor of κ from one iteration to the next
};

/// Anchors at wrong places (anchor_posterior.h).
struct OutlierAnchorSettings {
  double expected = 0.1;        ///< ε, share of the anchors
  double min_deviation = 0.02;  ///< diagonals: proportions differ that much
  int min_tested = 7;           ///< with fewer the others do not tell
};

/// Places by their distances along the surfaces from the anchors (anchor_geodesics.h).
struct GeodesicSettings {
  int count = 400;           ///< places of the source that a counterpart is looked for
  int min_anchors = 4;       ///< fewer name no place
  int max_anchors = 32;      ///< measured from, those farthest apart
  int min_vertices = 4000;   ///< over the whole surface: longer edges are halved
  int max_vertices = 20000;  ///< that are described
  double softening = 3e-3;   ///< ε, of the largest distance
  double max_return = 0.03;  ///< diagonals: a counterpart's counterpart may be so far off
  double elsewhere = 0.1;    ///< diagonals of the target: farther from the counterpart is another place
  double max_ratio = 0.5;    ///< of the misfits there and elsewhere
};

/// The source posed by its anchors alone (anchor_pose.h), as in as-rigid-as-possible modelling.
struct PoseSettings {
  /// Over the whole surface, coarse and fine as in the fit. Coarse nodes alone bend fingers at wrong places.
  std::array<int, 2> nodes = {400, 2500};
  /// Weight of the differences between similarities of neighbouring coarse nodes; fine nodes get the same
  /// stiffness. Falls geometrically: large rotations spread before they concentrate at joints.
  double first_smoothness = 100, last_smoothness = 0.1;
  std::array<int, 2> iterations = {60, 10};  ///< of places and similarities in turn, coarse and fine
  int sweeps = 3;                            ///< over the similarities, an iteration
  /// Spacings: expected misfit of an edge. With an anchor's σ it weighs anchors against shape.
  double edge_misfit = 0.5;
  double min_sigma = 1e-3;            ///< diagonals: no anchor counts as more accurate
  double sigma_of_weight_one = 0.01;  ///< diagonals: σ of a soft anchor of weight 1
  /// σ: an anchor may be so much farther from its target than closest points reach
  /// (NodeFitSettings::max_distance) before the fit starts from the posed source.
  double anchor_reach = 3;
  /// Degrees: the same for nearly rigid pairs (NodeGoals::rigidity above 1), whose anchors determine the
  /// pose.
  double min_rigid_turn = 15;
  NodeSettings node_settings;
  GeodesicSettings geodesics;
  OutlierAnchorSettings outliers{.min_deviation = 0.04};  ///< as distances along the surfaces tell them
  double pair_sigma = 0.01;  ///< diagonals: σ of what distances along the surfaces tell
};

/// Cavities of the source that the target lacks (cavities.h).
struct CavitySettings {
  double reach = 0.1;       ///< diagonals, between walls that face each other
  double min_cosine = 0.3;  ///< as NodeFitSettings::min_cosine, also between walls that face each other
  /// Of the vertex's distance from a target point: a source place nearer than that is the point's
  /// counterpart.
  double much_nearer = 0.7;
};

/// Whole cavities (mesh/cavities.h) that the target lacks (unmatched_cavities.h).
struct UnmatchedCavitySettings {
  /// Of a cavity's area: with less enclosed about its middle, the target lacks it.
  double min_matched = 0.25;
  double around = 2;         ///< radii of a cavity about its middle: the places that carry its space
  std::size_t places = 300;  ///< at most: the system is dense
  /// Of each place in the smoothing warp (GlobalRbf). Exact ones follow eyelids that the target has closed.
  double weight = 100;
  double min_width = 1e-3;  ///< of the largest width: flatter sets of places do not determine a warp
};

/// Correspondences without a reciprocal one (reciprocity.h): fingers that a scan lacks must not be registered
/// to their neighbours.
struct ReciprocitySettings {
  double much_nearer = 0.5;  ///< of a pair's distance: a source place nearer to the target point takes it
  double power = 4;          ///< of how much nearer: the pair's weight fades
  double rounding = 1e-6;    ///< of the largest distance searched: nearer points are reciprocal
};

/// Sources that anchors have posed and that still lie outside the target (pose_certainty.h): where anchors
/// determine the pose, a signed residual along the normal is a difference of shape.
struct OutsideResidualSettings {
  double reach = 0.2;  ///< diagonals: r of the certainty
};

/// One level of nodes.
struct NodeLevel {
  int nodes = 0;                 ///< requested, over the whole surface
  int iterations = 0;            ///< each searches the correspondences anew
  std::size_t samples = 0;       ///< source vertices with a correspondence
  std::size_t back_samples = 0;  ///< target vertices with one
  bool reciprocity = true;  ///< ReciprocitySettings. Not at the coarse level: distances say little there.
  bool outside_residuals = true;  ///< OutsideResidualSettings
};

/// The smooth deformation (node_fit.h): non-rigid ICP with an M-estimator on an embedded deformation graph.
struct NodeFitSettings {
  std::array<NodeLevel, 2> levels = {NodeLevel{400, 15, 5000, 2000, false, false},
                                     NodeLevel{2500, 9, 8000, 5000}};
  /// Of the first level without anchors, where surfaces converge more slowly. More let a shape without
  /// features drift along itself.
  int unanchored_iterations = 20;
  double coarsest_smoothing = 0.5;  ///< ℓ at the first iteration, diagonals
  double finest_smoothing = 0.01;   ///< ℓ at the last; geometric in between
  int boundary_start = 4;           ///< iteration at which cuts are compared: anchors and surfaces come first
  double min_cosine = 0.3;          ///< between normals of counterparts: within 73 degrees
  double max_distance = 0.1;        ///< diagonals, between counterparts
  /// Diagonals: weight of normals in the distance. Bulges find each other, not the nearest flat part.
  double normal_length = 0.02;
  double outlier_medians = 4;   ///< scale of the M-estimator, median distances: weight 1/2 there
  double outlier_floor = 1e-4;  ///< diagonals, added to that scale, where half of the pairs coincide
  /// Of ℓ, added to that scale where far pairs count too (PlanePair::outlier_scale_gain): in sharp creases,
  /// which must unfold, and for posed sources outside the target (OutsideResidualSettings).
  double outlier_scale_gain = 1;
  /// Weight of all exact anchors together, times the iteration's number from the second on; the surface's is
  /// 1. It grows, so that anchors lead and leave no dents.
  double anchor_growth = 2;
  double whole_surface_weight = 100;  ///< soft weights are percentages: this one equals the surface's
  double back_share = 0.5;            ///< weight of target-to-source pairs beside source-to-target ones
  double free_floating = 1e-9;        ///< added to every node's diagonal: a component without pairs stays
  AreaSettings areas;
  NodeSettings nodes;
  BendingSettings bending;
  ShapeSettings shape;
  BoundarySettings boundaries;
  AnchorSettings anchors;
  OutlierAnchorSettings outliers;
  CavitySettings cavities;
  UnmatchedCavitySettings unmatched_cavities;
  ReciprocitySettings reciprocity;
  OutsideResidualSettings outside_residuals;
};

/// Layers of space (detail_layers.h): sums of Wendland's C4 functions, coarse to fine.
struct DetailSettings {
  double coarsest = 0.06;   ///< λ of the first scale, diagonals: some two spacings of the fine nodes
  double ratio = 0.6;       ///< of λ from scale to scale
  int scales = 6;           ///< the last λ is 0.5 % of the diagonal: the spacing of some 13,000 vertices
  int steps_per_scale = 2;  ///< each searches the correspondences anew
  double centers_per_radius = 3;  ///< λ over the spacing of centres: well conditioned with Wendland's C4
  double min_cosine = 0.3;        ///< as NodeFitSettings::min_cosine
  double min_reach = 0.01;        ///< diagonals: counterparts may be this far apart, or λ if that is more
  double slide = 0.1;             ///< weight of point-to-point beside point-to-plane residuals
  ReciprocitySettings reciprocity;
  double stay = 0.03;         ///< weight of staying in place, against noise in single points
  double max_move = 0.3;      ///< of λ, of a layer
  double max_gradient = 0.5;  ///< largest ‖∇u‖ of a layer at the vertices: below 1 there is no fold
  SmoothLayerOptions solver;
  double anchor_radius = 0.03;  ///< diagonals: λ of the last layer, which matches exact anchors
  /// Diagonals: further anchor layers follow, so many at most, until all exact anchors are as near as this;
  /// face repair may have moved one.
  double tolerance = 1e-5;
  int max_anchor_passes = 4;
};

/// Misoriented faces, reset to a harmonic extension (misoriented_faces.h), except for patches that this would
/// bend farther. Edges folded anew by more than a right angle are repaired as well.
struct FaceRepairSettings {
  /// Against the coarse deformation: a face beyond lies on the wrong side of a fold.
  double max_degrees = 55;
  /// Factor of a length in a face, either way, against the coarse deformation
  /// (SurfaceFitOptions::max_stretch). Faces of true correspondences stay below 6.
  double max_stretch = 10;
  int max_rings = 8;  ///< of vertices around a misoriented face that are released with it
  /// Of the vertices, and a number for small meshes. Where more are misoriented, anchors contradict each
  /// other, and the repair would undo the fit.
  double max_released = 0.05;
  std::size_t released_at_least = 100;
};

/// Confidence of a vertex's correspondence. Reported; shapes nothing.
struct ConfidenceSettings {
  double near = 0.002;  ///< diagonals: the distance at which it falls to 1/e
  double reach = 0.01;  ///< diagonals: farther points count as none
};

struct DeformationGraphSettings {
  /// An edge longer than √(area / this) is halved, so that nodes lie on vertices and edges bend as well.
  double edges_per_area = 1125;
  SimilaritySettings similarity;
  PoseSettings pose;
  NodeFitSettings nodes;
  DetailSettings details;
  FaceRepairSettings face_repair;
  ConfidenceSettings confidence;
};

}  // namespace bespoke
