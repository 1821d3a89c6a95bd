#pragma once

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/types.h"

namespace bespoke {

/// A point on or near the source and its counterpart on the target (q ∈ G_a, q' ∈ G_b). Neither need lie on a
/// surface.
struct AnchorPair {
  std::string name;                                         ///< may be empty
  Vector3 a;                                                ///< source frame, mesh units
  Vector3 b;                                                ///< target frame, mesh units
  double weight = std::numeric_limits<double>::infinity();  ///< > 0, no unit; infinite = none given
  /// Accuracy: the standard deviation of each coordinate of the pair, ≥ 0, mesh units; 0 is met exactly.
  /// Empty: what the weight says, and without a weight it is estimated (anchor_accuracy.h).
  std::optional<double> sigma = std::nullopt;
};

/// A line on the source and its counterpart on the target, for instance a waist line. What lies on one goes
/// onto the other; where along it is found by the fit, except for fixed points.
struct AnchorCurve {
  std::string name;  ///< may be empty
  Points a;          ///< 3×n, a polyline, source frame, mesh units
  Points b;          ///< 3×m, target frame, mesh units
  bool closed = false;
  /// Points of a and of b, by number from 0, that belong together; rising on both sides.
  std::vector<std::pair<int, int>> fixed = {};
};

/// A part of a model's surface: what a line around it encloses, or its faces themselves.
struct PatchSide {
  Points border = Points(3, 0);  ///< 3×n, a closed polyline on the surface, mesh units
  std::vector<int> faces = {};   ///< by their numbers from 0

  bool is_empty() const { return border.cols() == 0 && faces.empty(); }
};

/// A part of the source and its counterpart on the target: what lies inside the one goes inside the other,
/// and border goes onto border. Or parts that have no counterpart, for instance a stand, hair, or what filled
/// a hole of a scan.
struct AnchorPatch {
  std::string name;      ///< may be empty
  PatchSide a;           ///< source
  PatchSide b;           ///< target
  bool exclude = false;  ///< attracts nothing and is attracted by nothing; one side may be empty then
};

struct Anchors {
  std::string unit;  ///< as the file says it, for instance "cm"; empty when it does not
  std::vector<AnchorPair> pairs;
  std::vector<AnchorCurve> curves = {};
  std::vector<AnchorPatch> patches = {};
};

/// Reads JSON {"units"?, "pairs"?, "curves"?, "patches"?} or, by the ending .csv, rows
/// name,ax,ay,az,bx,by,bz[,weight[,sigma]] with an optional header row (samples/cookbook/anchors.md). Throws
/// FileError, or FormatError naming the file, the line or the pair, and what is wrong: a number not finite in
/// single precision, weight ≤ 0, sigma < 0, both of them, a missing key, two pairs or two patches of one
/// name, a patch with one side that excludes nothing.
Anchors read_anchors(const std::filesystem::path& path);

/// The same of a text in JSON, which messages call `name`. anchors_json (anchor_files.h) writes such texts.
Anchors parse_anchors(const std::string& text, const std::string& name);

/// Appends the eight corners of the bounding boxes as exact pairs (σ = 0) named "corner_000" … "corner_111"
/// (x, y, z; Fig. 5). The boxes are those of the source and of the target in the source's frame, H'_b, which
/// the pairs already there fix (Eq. 2–6): a model that is turned has other corners. With fewer than three
/// pairs nothing is known of a turn, and the target is taken as it stands. Vertices: 3×n, mesh units. Throws
/// InvalidInput when there are no vertices, the pairs are collinear, or a name is taken.
void add_box_corners(Anchors& anchors, const Points& source_vertices, const Points& target_vertices);

/// Whether a pair has to be met: it has no weight, and its σ is 0 or not given.
bool is_exact(const AnchorPair& pair);

/// Whether a pair has neither a given weight nor a given σ.
bool has_no_given_sigma(const AnchorPair& pair);

/// 3×n each, n and n: the pairs as matrices; a σ that is not given is 0.
Points source_points(const Anchors& anchors);
Points target_points(const Anchors& anchors);
Eigen::VectorXd weights(const Anchors& anchors);
Eigen::VectorXd sigmas(const Anchors& anchors);

/// The weights, with those that a σ above 0 has in terms of a smoothing spline: (c / σ)², since it is by some
/// c = 10 % of the targets' diagonal that bodies differ across their length.
Eigen::VectorXd spline_weights(const Anchors& anchors);

/// How messages call a pair: its name in quotes, or "pair 3" for the third.
std::string label(const Anchors& anchors, std::size_t index);

}  // namespace bespoke
