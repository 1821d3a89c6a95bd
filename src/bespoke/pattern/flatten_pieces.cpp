#include "bespoke/pattern/flatten_pieces.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>

#include "bespoke/error.h"
#include "bespoke/parallel.h"
#include "bespoke/pattern/flattening/anderson.h"
#include "bespoke/pattern/flattening/barrier_descent.h"
#include "bespoke/pattern/flattening/flat_start.h"
#include "bespoke/pattern/flattening/local_global.h"
#include "bespoke/pattern/flattening/paired_seams.h"

namespace bespoke {
namespace {

constexpr double first_seam_weight = 1;
constexpr double seam_weight_growth = 10;
constexpr int seam_weights = 4;

// Of the largest piece's diagonal, how far a vertex moves in one iteration: on a garment a ten-thousandth of
// a millimetre, a thousandth of what a cutter repeats.
constexpr double still = 1e-7;

// Of the energy, what a round of iterations must lower it by. Below that, places move, but lengths hardly.
constexpr double min_gain = 1e-4;
constexpr int round_of_iterations = 10;

/// A state and what the iteration needs beside it.
struct Descent {
  FlatState x;
  double energy = 0;
  double small_move = 0;  ///< millimetres at which it ends
};

double largest_diagonal(const std::vector<Piece>& pieces) {
  double largest = 0;
  for (const Piece& piece : pieces) largest = std::max(largest, diagonal(piece.mesh.vertices));
  return largest;
}

std::vector<Eigen::Matrix2Xd> starts(const std::vector<Piece>& pieces, FlattenSummary& summary) {
  std::vector<Eigen::Matrix2Xd> flat(pieces.size());
  summary.starts.assign(pieces.size(), FlatteningStart::conformal);
  parallel_for(pieces.size(), 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t p = first; p < last; ++p) {
      const std::vector<RestFace> rest = rest_faces(pieces[p].mesh);
      if (std::optional<Eigen::Matrix2Xd> start = conformal_start(pieces[p], rest)) {
        flat[p] = std::move(*start);
      } else {
        summary.starts[p] = FlatteningStart::tutte;
        flat[p] = tutte_start(pieces[p], rest);
      }
    }
  });
  return flat;
}

double widest_gap(const std::vector<Seam>& seams, const std::vector<Eigen::Matrix2Xd>& flat) {
  double gap = 0;
  for (const Seam& seam : seams) {
    const auto length = [&](std::size_t side) {
      return side_length(seam.sides[side], flat[static_cast<std::size_t>(seam.sides[side].piece)]);
    };
    gap = std::max(gap, std::abs(length(0) - length(1) - seam.ease));
  }
  return gap;
}

/// A step towards `to` that flips nothing and does not raise the energy; false where there is none.
bool step_towards(const LocalGlobal& problem, const FlatState& to, Descent& descent) {
  constexpr int halvings = 12;
  double step = problem.unflipped_step(descent.x, to);
  for (int k = 0; k < halvings; ++k, step /= 2) {
    FlatState x = descent.x + step * (to - descent.x);
    const double energy = problem.energy(x);
    if (energy <= descent.energy && problem.is_unflipped(x)) {
      descent.x = std::move(x);
      descent.energy = energy;
      return true;
    }
  }
  return false;
}

/// Alternates local and global steps with one weight of the seams.
void descend(const LocalGlobal& problem, int max_iterations, Descent& descent, FlattenSummary& summary) {
  descent.energy = problem.energy(descent.x);
  summary.is_converged = false;
  Anderson anderson;
  double energy_before = descent.energy;
  for (int k = 0; k < max_iterations; ++k) {
    if (k > 0 && k % round_of_iterations == 0) {
      summary.is_converged = descent.energy > (1 - min_gain) * energy_before;
      if (summary.is_converged) return;
      energy_before = descent.energy;
    }
    const FlatState image = problem.next(descent.x);
    ++summary.iterations;
    summary.last_move = std::sqrt((image - descent.x).colwise().squaredNorm().maxCoeff());
    if (summary.last_move < descent.small_move) {
      summary.is_converged = true;
      return;
    }
    const Eigen::VectorXd guess = anderson.next(descent.x.reshaped(), image.reshaped());
    FlatState accelerated = guess.reshaped(2, descent.x.cols());
    const double energy = problem.energy(accelerated);
    if (energy < descent.energy && problem.is_unflipped(accelerated)) {
      descent.x = std::move(accelerated);
      descent.energy = energy;
      continue;
    }
    anderson.forget();
    if (!step_towards(problem, image, descent)) return;
  }
}

/// Whether a face has hardly any area left.
bool has_collapsed(const Piece& piece, const std::vector<RestFace>& rest, const Eigen::Matrix2Xd& flat) {
  constexpr double collapsed = 0.02;  // of its area; cloth that loses half tears already
  for (Eigen::Index f = 0; f < piece.mesh.faces.cols(); ++f)
    if (face_jacobian(rest[static_cast<std::size_t>(f)], piece.mesh.faces.col(f), flat).determinant() <
        collapsed)
      return true;
  return false;
}

/// Pieces whose faces collapse, from their starts.
void hold_open(const std::vector<Piece>& pieces, const std::vector<Eigen::Matrix2Xd>& start,
               FlatPieces& result) {
  std::vector<char> is_held(pieces.size(), 0);
  parallel_for(pieces.size(), 1, [&](std::size_t first, std::size_t last) {
    for (std::size_t p = first; p < last; ++p) {
      const std::vector<RestFace> rest = rest_faces(pieces[p].mesh);
      is_held[p] = has_collapsed(pieces[p], rest, result.places[p]);
      if (is_held[p]) result.places[p] = barrier_descent(pieces[p], rest, start[p]);
    }
  });
  result.summary.held_open = static_cast<int>(std::count(is_held.begin(), is_held.end(), 1));
}

}  // namespace

std::string to_string(const FlattenSummary& summary) {
  std::string text =
      std::to_string(summary.iterations) + (summary.iterations == 1 ? " iteration" : " iterations");
  char move[64];
  std::snprintf(move, sizeof move, "last move %.2g mm", summary.last_move);
  text += summary.is_converged ? ", converged" : std::string(", not converged, ") + move;
  const auto tutte = std::count(summary.starts.begin(), summary.starts.end(), FlatteningStart::tutte);
  if (tutte > 0) text += ", " + std::to_string(tutte) + " pieces from Tutte's map";
  return text;
}

FlatPieces flatten_pieces(const std::vector<Piece>& pieces, const std::vector<Seam>& seams,
                          const FlattenOptions& options) {
  FlatPieces result;
  if (pieces.empty()) return result;
  const std::vector<Eigen::Matrix2Xd> start = starts(pieces, result.summary);
  result.places = start;
  // Areas are kept in many ways: from the lengths' flattening, the nearest is found.
  std::vector<FlatteningMethod> methods{options.method};
  if (options.method == FlatteningMethod::authalic) methods.insert(methods.begin(), FlatteningMethod::rigid);
  for (const FlatteningMethod method : methods) {
    LocalGlobal problem(pieces, seams, method);
    Descent descent{problem.joined(result.places), 0, still * largest_diagonal(pieces)};
    double weight = first_seam_weight;
    for (int k = 0; k < seam_weights; ++k, weight *= seam_weight_growth) {
      result.summary.seam_weight = seams.empty() ? 0 : weight;
      problem.set_seam_weight(weight);
      descend(problem, options.max_iterations, descent, result.summary);
      result.places = problem.parted(descent.x);
      if (widest_gap(seams, result.places) <= options.seam_tolerance) break;
    }
  }
  hold_open(pieces, start, result);
  return result;
}

}  // namespace bespoke
