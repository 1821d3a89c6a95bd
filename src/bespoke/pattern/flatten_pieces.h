#pragma once

#include <array>
#include <string>
#include <vector>

#include "bespoke/enum_names.h"
#include "bespoke/pattern/piece.h"

namespace bespoke {

/// What the flattening keeps as well as the shape allows.
enum class FlatteningMethod {
  rigid,      ///< lengths: as rigid as possible (Liu, Zhang, Xu, Gotsman and Gortler 2008)
  conformal,  ///< angles: as similar as possible (the same paper)
  authalic,   ///< areas: the nearest stretches of product 1
};

inline constexpr std::array flattening_methods{
    Named<FlatteningMethod>{"rigid", FlatteningMethod::rigid},
    Named<FlatteningMethod>{"conformal", FlatteningMethod::conformal},
    Named<FlatteningMethod>{"authalic", FlatteningMethod::authalic}};

struct FlattenOptions {
  FlatteningMethod method = FlatteningMethod::rigid;
  double seam_tolerance = 1;  ///< millimetres that the sides of a seam may differ by
  int max_iterations = 300;   ///< for each weight of the seams
};

enum class FlatteningStart {
  conformal,  ///< least squares conformal map (Lévy, Petitjean, Ray and Maillot 2002), where it is injective
  tutte,      ///< barycentric map into a circle (Tutte 1963; Floater 1997)
};

struct FlattenSummary {
  std::vector<FlatteningStart> starts;  ///< one a piece
  int iterations = 0;
  double last_move = 0;    ///< of a vertex in the last iteration, millimetres
  double seam_weight = 0;  ///< the last one, in units of the weight of an edge inside a piece
  bool is_converged = false;
  int held_open = 0;  ///< pieces that would have collapsed faces, and took the symmetric Dirichlet energy
};

/// "12 iterations, converged" and how pieces started, unless all did by the conformal map.
std::string to_string(const FlattenSummary& summary);

struct FlatPieces {
  std::vector<Eigen::Matrix2Xd> places;  ///< one a piece: 2×n, millimetres, no triangle flipped
  FlattenSummary summary;
};

/// Flattens all pieces as one problem: minimises, with J a face's Jacobian (flat from surface) and P(J) the
/// nearest rotation (similarity, matrix of determinant 1),
///
///     Σ_faces area |J − P(J)|²  +  w Σ_seams Σ_edges |e − p(e)|² + |e' − p(e')|²
///
/// where p makes paired edges e, e' equally long, or as different as the seam's ease wants them. Local and
/// global steps alternate (one factorisation), accelerated as Anderson's (Peng et al. 2018); no step flips a
/// triangle. w grows tenfold, three times, while a seam's sides differ by more than the tolerance. Pieces
/// that can be unrolled come back exactly. Same bits at any number of threads. Throws InvalidInput for a
/// piece with a face without area, SolverError where a piece has no start without flips.
FlatPieces flatten_pieces(const std::vector<Piece>& pieces, const std::vector<Seam>& seams,
                          const FlattenOptions& options = {});

}  // namespace bespoke
