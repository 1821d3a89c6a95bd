#pragma once

#include "bespoke/rigid/similarity_alignment.h"

namespace bespoke {

/// The affine map of point pairs, as far as their spread determines it. With principal directions d_k of the
/// sources, widest first, σ_k their standard deviations, s R the least-squares similarity, D the slopes of
/// its residuals, and ρ_k the standard deviation without a slope along d_k, in the sources' unit:
///   A = s R + Σ κ_k D d_k d_kᵀ,    κ_k = σ_k² / (σ_k² + ρ_k²),
/// ridge regression (Hoerl, Kennard 1970). Pairs in one plane give no slope across it.
struct RegularisedAlignment {
  Similarity similarity;
  AffineMap affine;                      ///< drawn towards the similarity where κ is small
  Matrix3 directions;                    ///< columns d_k
  Vector3 widths = Vector3::Zero();      ///< σ_k, mesh units of the sources
  Vector3 determined = Vector3::Zero();  ///< κ_k, 0 … 1
  Vector3 source_centre = Vector3::Zero();

  /// Whether the spread exceeds the misfit in every direction: an affine map follows from the pairs.
  bool determines_affine_map() const { return determined[2] >= 0.5; }
  /// The same in two directions: a rotation follows, not only a line that goes onto a line.
  bool determines_rotation() const { return determined[1] >= 0.5; }
};

/// Of at least three pairs (3×n each, mesh units) with weights (n, > 0, finite). Throws InvalidInput for
/// others, and as align_similarly.
RegularisedAlignment align_regularised(const Points& source, const Points& target,
                                       const Eigen::VectorXd& weights);

/// Of the sources' reflection across the plane through their centre whose normal is their thinnest direction:
/// with this similarity after it the improper similarity of least squares.
Points reflected(const RegularisedAlignment& alignment, const Points& x);

}  // namespace bespoke
