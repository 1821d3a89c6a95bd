#pragma once

#include <array>
#include <cstddef>

namespace bespoke {

// Every tuned constant of the default surface fit, one struct for each stage. "Diagonal" is that of the
// bounding box of the aligned source. Where a sentence gives a factor, it is the geometric mean over the
// eight shared cases of mean and 95th percentile of the true error against the value chosen here ("x 1.01":
// one per cent worse); two factors are those of the shared cases and of 21 further pairs cut and turned from
// their models. "Not varied" means that nobody has tried another value.

/// One similarity for the whole source (similarity_fit.h).
struct SimilaritySettings {
  /// Diagonals: a similarity whose plane residual stays within it explains the target. Above the remeshing
  /// noise of a faithful copy, whose vertices lie within 0.013 % of the diagonal at the 95th percentile
  /// (d00). Not varied.
  double tolerance = 5e-4;
  double anchor_tolerance = 2;  ///< tolerances: so far off may exact anchors stay then. Not varied.
  /// Of the residuals, area by area: so many must be within the tolerance, so that holes and debris do not
  /// decide. Not varied.
  double quantile = 0.9;
  int max_iterations = 12;  ///< Gauss-Newton steps at most. Not varied.
  int trial_iterations =
      3;  ///< after these a early_exit_factor fit is given up: saves time only. Not varied.
  double early_exit_factor = 8;  ///< tolerances, of the residual after the trial iterations. Not varied.
  double max_distance = 0.05;    ///< diagonals: farther points are no counterparts. Not varied.
  double min_cosine = 0.5;       ///< between the normals of counterparts: within 60 degrees. Not varied.
  double outlier_medians = 2;  ///< median residuals: there a residual's weight falls to one half. Not varied.
  double outlier_floor = 1e-12;  ///< of the largest distance: keeps the weights finite on an exact copy.
  /// Vertices asked at most: bounds the time; seven unknowns need few. 16,000: the same errors on d00 to d10.
  std::size_t max_samples = 4000;
};

/// How far each vertex speaks in a fit of planes (informative_areas.h). Taken for x 0.996 / 0.991.
struct AreaSettings {
  double length = 0.01;  ///< ℓ, diagonals: bends of this radius count twice. Not varied on its own.
  double max_weight =
      4;  ///< added to 1 at most: bounds the weight that noise in the normals can give. Not varied.
  double shortest =
      1e-4;  ///< diagonals: shorter edges count as this long, their normals are rounding. Not varied.
};

/// Nodes and how vertices follow them (deformation_nodes.h).
struct NodeSettings {
  /// Nodes that a vertex follows: a neighbourhood in the plane at the reach below has about as many. Not
  /// varied.
  static constexpr int per_vertex = 8;

  double follow_reach = 2.6;  ///< spacings: a vertex follows nodes up to there. Not varied.
  double neighbour_reach =
      2.3;                 ///< spacings between linked nodes; 1.8 and 3 change the errors by less than 1 %.
  int min_neighbours = 8;  ///< fewer do not determine an affine map robustly. Not varied.
  /// Nodes × spacing² / area of dense thinning: turns a count of nodes into a spacing. Fewer come, since
  /// distances along edges are longer than straight ones: 0.6 of the count on a sphere. Not varied.
  double packing = 0.75;
  /// Of the area: where components large enough for nodes cover less, the mesh is taken for a polygon soup,
  /// and distances are those in space. Not varied.
  double min_carried_area = 0.5;
  /// Of the farthest followed node's distance: weights fall to zero there, so that a node fades out before it
  /// is dropped. Not varied.
  double fade_margin = 1.05;
  double weight_floor = 1e-9;  ///< of a weight: keeps the sum positive when all nodes lie at the reach.
  /// Of the trace of the nodes' spread, added across all directions: across the surface the nodes say nothing
  /// about slopes. Not varied.
  double flatness = 0.02;
  double spread_floor =
      1e-3;  ///< squared spacings, added to the spread: one node alone has none. Not varied.
};

/// Second differences of the nodes' displacements (deformation_nodes.h).
struct BendingSettings {
  double squared_width = 3;    ///< squared spacings: a neighbour's weight is exp(−r² / this). Not varied.
  double weight_floor = 1e-2;  ///< keeps distant components tied, where the exponential vanishes. Not varied.
  /// Decides slopes across a flat neighbourhood, which no node shows; no unit, beside a Gram matrix of
  /// order 1.
  double slope_penalty = 1e-3;
  /// Of a local scale over the median one, either way. A node bends by its area at rest times the square: the
  /// area that it has now, but where a pose has grown it before, which counts twice. Bounds it where the
  /// surface has collapsed; not varied. The area now in poses too: d08 and d10 x 0.993 / 0.990, nine posed
  /// pairs x 1.006 / 1.012, a flipped face of d08. 1, without it: the nine cases x 1.000 / 0.996, with 1 % of
  /// noise x 0.996 / 0.996, with five anchors x 1.009 / 1.013, the other way round x 0.995 / 0.992, 24 pairs
  /// of their bodies, a source of one on the target of another, x 1.005 / 1.010, with five anchors x 1.008
  /// / 1.007; 164 flipped faces, not 138, and three with noisy or few anchors on d01 to d07, not none. The
  /// fourth power: x 1.001 / 1.001, the 24 pairs x 0.997 / 0.995, but 139 flipped faces there, not 96.
  double max_growth = 10;
};

/// How much the surface keeps its shape, node by node (node_system.h). Besides the shared cases, five bodies
/// in two poses each were tried, remeshed and turned at shoulders, elbows, hips and knees by 1 to 80 degrees.
struct ShapeSettings {
  /// Of ℓ: the length over which local similarity counts. 0.05: x 1.02, 0.07: x 1.01, 0.15: x 1.015; without
  /// local similarities 0.665 of the best other program's error instead of 0.646.
  double share = 0.1;
  /// Of the logarithm of a local scale over the median one: the freedom that a part has to grow more than the
  /// others. 1: x 1.012 / 1.014, 0.25: x 0.996 / 0.993 but d09's map 0.188 instead of 0.130 % from the
  /// target, 0: x 0.997 / 0.994; within 0.5 % on the bodies.
  double scale_freedom = 0.5;
  /// Strain after the first level (NodeSystem::median_strain). Where a pair has less, both models are nearly
  /// one: the share grows by the ratio, and bending costs less. With the pose that follows from it
  /// (PoseSettings) and what else changed with it, x 0.72 / 0.79 on the bodies, x 0.97 / 0.95 on the
  /// shared cases. 0.06: x 0.987 / 0.980 on the bodies, x 0.998 on the shared cases, but a sphere that
  /// bends and grows smoothly has an error of 0.0091 instead of 0.0076 of its radius, without any of this
  /// 0.0065. Strain judged region by region: x 1.12 on the bodies, for it is at the joints that the rigid
  /// rest must say what happens.
  double usual_strain = 0.05;
  double max_rigid = 10;  ///< bounds the ratio, for exact copies. Not varied.
};

/// Which boundaries are the same cut (boundary_match.h).
struct BoundarySettings {
  /// Stretch of the strip between the boundary and the nearest anchor. Chosen on the open heads, hands and
  /// the foot of the shared cases; together with a lower stiffness, matching took the errors from 0.738 to
  /// 0.665 of the best other program's.
  double max_stretch = 0.5;
  double must_agree = 0.9;  ///< of a boundary's vertices, so that notches do not decide. Not varied.
};

/// Anchors of limited accuracy (anchor_limits.h).
struct AnchorSettings {
  /// τ, diagonals: what the surfaces leave open along themselves where they meet. 0, 0.001 and 0.002 gave the
  /// mean errors of exact anchors times 1.277, 1.265 and 1.286 with 1 % of noise, 1.175, 1.145 and 1.154 with
  /// 0.3 %.
  double along_surface = 0.001;
  double max_reinforced = 10;  ///< factor of κ from one iteration to the next. Not varied.
};

/// The source bent by its anchors alone (anchor_pose.h). Errors are mean distances from the truth, diagonals.
struct PoseSettings {
  /// Over the whole surface, few first, as at the levels of the fit. Over d04, d05, d08, d10, d10 reversed
  /// and d01's source on d08, all bent: few alone, which bend fingers at the wrong places, x 1.09; many alone
  /// x 1.00, but with five anchors x 1.25.
  std::array<int, 2> nodes = {400, 2500};
  /// Weight of the differences between the similarities of neighbouring nodes, of the few; the many get the
  /// same stiffness. Falls geometrically, so that far turns spread before they settle at the joints. Last
  /// value 1, 0.1, 0.02: 0.639, 0.608, 0.611 % over d01, d04, d08 and d10 (geometric mean), with few alone.
  double first_smoothness = 100, last_smoothness = 0.1;
  /// Of places and similarities in turn, at either level. The second 5, 20, 40: x 1.00, 1.00, 1.00, with five
  /// anchors x 1.00, 1.00, 1.05.
  std::array<int, 2> iterations = {60, 10};
  int sweeps = 3;  ///< over the similarities, an iteration. Not varied.
  /// Spacings: expected misfit of an edge; with an anchor's accuracy it weighs anchors against shape. 0.1:
  /// 0.745 % instead of 0.608 %.
  double edge_misfit = 0.5;
  double min_sigma = 1e-3;            ///< diagonals: no anchor is taken for more accurate. Not varied.
  double sigma_of_weight_one = 0.01;  ///< diagonals: the accuracy that a soft anchor's weight of 1 stands for
  /// Accuracies: anchors may be so much farther from their targets than closest points reach
  /// (NodeFitSettings::max_distance), before the fit starts from the bent source. Not varied.
  double anchor_reach = 3;
  /// Degrees: the same of models that are rigid (NodeGoals::rigidity above 1), since what keeps its shape
  /// goes where its anchors say: x 0.846 / 0.982 on bodies in two poses (ShapeSettings), and no flip where
  /// there were 26. Smaller turns are found anyway. Not varied.
  double min_rigid_turn = 15;
  NodeSettings node_settings;
};

/// Cavities of the source that the target lacks (cavities.h).
struct CavitySettings {
  double reach = 0.1;       ///< diagonals: how far walls face each other, as counterparts may be apart.
  double min_cosine = 0.3;  ///< as NodeFitSettings::min_cosine, between walls that face each other too.
  /// Of the vertex's distance from a point of the target: where another place of the source is nearer, the
  /// point is that place's counterpart. 0.9 instead: errors of d01 to d10 within 0.3 %, one flip more.
  double much_nearer = 0.7;
};

/// Cavities of cavities that the target lacks (unmatched_cavities.h). Tried on an avatar's head with a mouth
/// and sockets, laid onto three that have none, two of them scans of sculptures.
struct UnmatchedCavitySettings {
  /// Of a lining's area: where less of the target is enclosed about its middle, the target lacks it. Not
  /// varied.
  double min_matched = 0.25;
  double around = 2;         ///< radii of a lining about its middle: so far places speak for its space
  std::size_t places = 300;  ///< at most: a dense system
  /// Of each in the warp (GlobalRbf). Lids lie crumpled on eyes that the target has closed: met exactly, they
  /// threw sockets out of the face; 1,000: less so; 10, or 3 radii: as here.
  double weight = 100;
  double min_width = 1e-3;  ///< of the largest: thinner, places say nothing of space
};

/// Counterparts that belong to another place (reciprocity.h). Taken for scans: nine of the shared targets
/// with 0.08 % of noise, eight holes of 2.5 % of the diagonal and debris, where fingers and toes had been
/// laid onto their neighbours: x 0.91 / 0.89, flipped faces 247 to 12; on the shared cases x 1.004 / 1.002,
/// on 16 further pairs x 1.001 / 1.003, on seven pairs whose anchors are off by 1 %, five times, x 1.005
/// / 1.003 and 275 flipped faces to 49.
struct ReciprocitySettings {
  /// Of the distance of a point from its match: what takes the match away is so much nearer. 0.35: scans
  /// x 1.005, the shared cases x 0.998.
  double much_nearer = 0.5;
  /// Of how much nearer: the pair fades. Cut off instead: scans the same, posed bodies and hands x 1.01.
  double power = 4;
  double rounding = 1e-6;  ///< of the largest distance that is asked: nearer points are their matches.
};

/// Sources that anchors have bent and that stand out of the target (pose_certainty.h). Factors over fourteen
/// pairs, twelve of them bent (bodies and hands in strong poses, d08 and d10 among them), with all anchors:
/// without x 1.027 / 1.029, d10 x 1.08; where the target stands out too (at both levels, everywhere, 0.3 of
/// the leeway), x 1.02 / 1.03, a squat x 1.13.
struct OutsideResidualSettings {
  /// Diagonals: r of the certainty. 0.15: x 1.002 / 1.003; 0.25: x 1.000 / 0.998, with five anchors x 1.002 /
  /// 1.000; infinite: x 0.999 / 0.996, but with five anchors x 1.018 / 1.020 and 1,617 flipped faces, not
  /// 1,000.
  double reach = 0.2;
};

/// One level of nodes.
struct NodeLevel {
  int nodes = 0;                 ///< aimed at, over the whole surface
  int iterations = 0;            ///< pairs are searched anew in each
  std::size_t samples = 0;       ///< source vertices that look for a counterpart
  std::size_t back_samples = 0;  ///< target vertices that do
  /// Whether pairs fade (ReciprocitySettings). Not at the first level, where surfaces are still far apart and
  /// any nearness says little: with it there, scans and the shared cases x 1.000, but hands whose anchors are
  /// off by 1 % go a finger astray more often (d08 over five such noises x 1.06, 64 flipped faces, not 36).
  bool reciprocity = true;
  /// Whether bent sources sink (OutsideResidualSettings). At the first level too, with an infinite reach:
  /// x 1.000 / 0.999, with five anchors x 1.011 / 1.012.
  bool outside_residuals = true;
};

/// The smooth deformation (node_fit.h).
struct NodeFitSettings {
  /// 2,500 nodes instead of 1,500: x 0.983 to 0.992 at about the same time, heads 5 % better. A third level
  /// of 8,000: x 0.992, but 22 flipped faces where there were 12. The fine level once had 16,000 and 6,000
  /// samples; half as many were taken for their time. 10 and 20 instead of 15 coarse iterations:
  /// x 1.009 / 1.015 and 1.000 / 0.993, on bodies in two poses x 1.017 / 1.035 and 0.993 / 0.980.
  /// Nine fine iterations, against six, on the nine shared cases that are not copies: x 0.996 / 0.993, on 17
  /// further pairs (poses, hands, other persons, scans) x 0.996 / 0.993; on the nine with 0.3 % and 1 % of
  /// noise in the anchors x 0.997 / 0.998 and 1.003 / 1.006, with five anchors x 0.995 / 1.002 and 22 flipped
  /// faces, not 54; for a twentieth of a fit's time. Eight: x 0.998 / 0.996 and 0.997 / 0.993; twelve:
  /// against nine x 0.997 / 1.001 on the nine cases, x 1.008 / 1.005 on them the other way round. Half of the
  /// coarse samples then: x 0.997 / 0.994 and 0.998 / 0.998, with 1 % of noise x 1.007 / 1.013.
  std::array<NodeLevel, 2> levels = {NodeLevel{400, 15, 5000, 2000, false, false},
                                     NodeLevel{2500, 9, 8000, 5000}};
  /// Of the first level where no anchor leads the surfaces, which slide into place more slowly. 15, 20, 25,
  /// 30, 40 on a hand (d04): 0.710, 0.655, 0.630, 0.612, 0.584 %; on bodies, heads and a curled hand within
  /// 4 %. But a smooth shape without features drifts on: more than 25 move it along itself.
  int unanchored_iterations = 20;
  double coarsest_smoothing = 0.5;  ///< ℓ at the first iteration, diagonals. Not varied on its own.
  /// ℓ at the last, diagonals; geometric in between. 0.007: x 1.009, 0.014: x 1.033.
  double finest_smoothing = 0.01;
  int boundary_start =
      4;  ///< iteration at which cuts are compared: anchors and surfaces come first. Not varied.
  double min_cosine =
      0.3;  ///< between the normals of counterparts: within 73 degrees. Not varied on its own.
  double max_distance = 0.1;  ///< diagonals: farther points are no counterparts. Not varied on its own.
  /// Diagonals: of points about as near the one that faces alike is the counterpart, so that bulges find each
  /// other. Taken for x 0.981, bodies 2 %.
  double normal_length = 0.02;
  double outlier_medians =
      4;  ///< median distances: there a pair's weight falls to one half. Not varied on its own.
  double outlier_floor = 1e-4;  ///< diagonals, added: where half of the pairs meet exactly. Not varied.
  /// Of ℓ, added to that distance where a pair counts also from far off (PlanePair::leeway). In sharp
  /// creases, which must unfold: 0: x 1.018 / 1.036 on the shared cases and 22 further pairs, x 1.11 / 1.22
  /// on three whose armpits stay notched; 0.6, 1.6: shared cases x 1.003 / 1.003 and 0.997 / 0.996; at every
  /// pair, creased or not, 0.2: x 0.994 / 0.998 on the shared cases, but d01 x 1.10. Of bent sources that
  /// stand out of the target, see OutsideResidualSettings.
  double outlier_scale_gain = 1;
  /// Weight of all exact anchors together after the first iteration of a level, times the iteration's number;
  /// the surface's weight is 1. Growing, so that anchors lead and do not dent. Not varied on its own.
  double anchor_growth = 2;
  /// A soft anchor of this weight counts like the whole surface: weights are percentages of it.
  double whole_surface_weight = 100;
  /// Weight of target-to-source pairs beside source-to-target ones. 0: 0.646 instead of 0.640 of the best
  /// other program's error; 1: within 1 % of this.
  double back_share = 0.5;
  double free_floating =
      1e-9;  ///< added to every node's diagonal: a component without any pair stays where it is.
  AreaSettings areas;
  NodeSettings nodes;
  BendingSettings bending;
  ShapeSettings shape;
  BoundarySettings boundaries;
  AnchorSettings anchors;
  CavitySettings cavities;
  UnmatchedCavitySettings unmatched_cavities;
  ReciprocitySettings reciprocity;
  OutsideResidualSettings outside_residuals;
};

/// Layers of space (detail_layers.h).
struct DetailSettings {
  double coarsest =
      0.06;            ///< λ of the first scale, diagonals: some two spacings of the fine nodes. Not varied.
  double ratio = 0.6;  ///< of λ from scale to scale. Not varied.
  int scales = 6;  ///< the last λ is 0.5 % of the diagonal: the vertex spacing of some 13,000. Not varied.
  /// Pairs are searched anew in each. 1, of eight scales from the same first to the same last λ: x 0.999 /
  /// 1.003 and 0.999 / 1.002 on the cases and pairs of NodeFitSettings::levels, four flipped faces more on a
  /// head; 3: x 1.002 / 0.999 and 1.004 / 0.999.
  int steps_per_scale = 2;
  double centers_per_radius =
      3;  ///< λ over the spacing of centres: well conditioned with Wendland's C4. Not varied.
  double min_cosine = 0.3;  ///< as NodeFitSettings::min_cosine
  /// Diagonals: at the fine scales counterparts may be this far off, else as far as λ. Normals in the
  /// nearness, as the nodes have them, gave 62 instead of 105 flips on the further pairs, but hands 8 %
  /// worse; pairs from target to source x 0.9925, but hands 3.7 % worse.
  double min_reach = 0.01;
  /// Weight of point to point beside point to plane. 0: 0.640 instead of 0.638 of the best other program's
  /// error.
  double slide = 0.1;
  ReciprocitySettings reciprocity;  ///< Without: scans x 1.06 / 1.06, flipped faces 263, not 12.
  double stay = 0.03;     ///< weight of staying in place, against noise in single points. Not varied.
  double max_move = 0.3;  ///< of λ: a layer moves nothing farther. Not varied.
  double max_gradient =
      0.5;  ///< largest ‖∇u‖ of a layer at the vertices: below 1 there is no fold. Not varied.
  double ridge = 1e-3;  ///< added to the kernel's diagonal of 1: bounds a layer's condition at some 1e4.
  int max_solver_iterations = 40;   ///< of conjugate gradients, a layer. Not varied.
  double solver_residual = 1e-6;    ///< of the squared right-hand side: moves are met to a thousandth.
  double negligible_kernel = 1e-6;  ///< kernel values left out of the matrix, far below the ridge.
  double anchor_radius = 0.03;  ///< diagonals: λ of the last layer, which meets exact anchors. Not varied.
  /// A layer meets them to a thousandth of its moves; where mending has taken one far from its place, another
  /// follows until all are within this many diagonals, so many at most. Not varied.
  double tolerance = 1e-5;
  int max_anchor_passes = 4;
};

/// Faces taken back (misoriented_faces.h), but for patches that this would bend farther. Without that
/// exception, on 41 pairs of bodies, hands, feet and heads made afresh: x 1.006, and 707 flipped faces
/// instead of 281, on heads whose nostrils and lids the coarse deformation had folded. Edges folded anew, by
/// more than a right angle, are mended as well: flipped faces of the maps of 17 further pairs 49 without
/// that, 33 with it (a noisy scan 9, 0; a body 6, 3), of the shared ones 1, 0; anchors with 0.3 % noise 3, 1;
/// five anchors 7, 4. Errors x 1.000, d06 x 1.003. From 60 and 75 degrees on: more faces flipped than
/// without.
struct FaceRepairSettings {
  /// A face that turned farther against the coarse deformation was drawn to the wrong side of a fold. Flipped
  /// faces at 45, 50, 55, 60, 65 degrees: 9 5 2 2 2 on the shared cases, 47 45 73 99 110 on the further
  /// pairs, where smoothing a crease still counted as turning (d05: 3 flipped faces instead of none, x 1.02).
  double max_degrees = 55;
  /// Factor by which a length in a face may grow or shrink against the coarse deformation, which is nearly a
  /// similarity about a face (SurfaceFitOptions::max_stretch). Of the true correspondences 99.9 % of all
  /// faces stay below 6 against one similarity. 10 and infinity: the same errors on d01 to d10; 5: d10 0.341
  /// % instead of 0.318.
  double max_stretch = 10;
  int max_rings = 8;  ///< of vertices around a turned face that are released with it. Not varied.
  /// Of the vertices, and a number for small meshes: where more has turned, anchors contradict each other,
  /// and mending would undo the fit: jittered anchors had a fifth of a foot taken back, and 77 faces flipped,
  /// now none.
  double max_released = 0.05;
  std::size_t released_at_least = 100;
  double shortest =
      1e-6;            ///< diagonals: edges shorter than this weigh no more; equal weights left faces turned.
  double keep = 1e-9;  ///< of a vertex's own weight: decides where a whole component is released.
};

/// How sure a vertex is of its counterpart. Reported, shapes nothing.
struct ConfidenceSettings {
  double near = 0.002;  ///< diagonals: the distance at which confidence falls to 1/e. Not varied.
  double reach = 0.01;  ///< diagonals: farther points count as none. Not varied.
};

struct DeformationGraphSettings {
  /// An edge longer than √(area / this) is halved: the spacing of 1,500 nodes, so that nodes have vertices to
  /// stand on and bend edges as well. Not varied since there are 2,500.
  double edges_per_area = 1125;
  SimilaritySettings similarity;
  PoseSettings pose;
  NodeFitSettings nodes;
  DetailSettings details;
  FaceRepairSettings face_repair;
  ConfidenceSettings confidence;
};

}  // namespace bespoke
