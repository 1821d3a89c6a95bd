#pragma once

#include <Eigen/SparseCholesky>
#include <memory>
#include <vector>

#include "bespoke/pattern/flatten_pieces.h"
#include "bespoke/pattern/flattening/flat_faces.h"

namespace bespoke {

/// The places of the vertices of all pieces behind one another: 2×N.
using FlatState = Eigen::Matrix2Xd;

/// The energy of flatten_pieces, and the two steps that lower it in turn. The first vertex of every piece's
/// outline stays where it is.
class LocalGlobal {
 public:
  LocalGlobal(const std::vector<Piece>& pieces, const std::vector<Seam>& seams, FlatteningMethod method);

  /// Of the seams, in units of an edge's own; factorises. Throws SolverError.
  void set_seam_weight(double weight);

  double energy(const FlatState& x) const;
  bool is_unflipped(const FlatState& x) const;

  /// Where the global step leads, with the targets of the local one at x.
  FlatState next(const FlatState& x) const;

  /// The largest step from x towards `to`, at most 1, that flips no face, with a margin.
  double unflipped_step(const FlatState& x, const FlatState& to) const;

  FlatState joined(const std::vector<Eigen::Matrix2Xd>& flat) const;
  std::vector<Eigen::Matrix2Xd> parted(const FlatState& x) const;

 private:
  struct Part;
  /// Two edges of one length, or that differ by what the seam eases, by the columns of a state.
  struct PairedEdge {
    std::array<std::array<int, 2>, 2> ends;
    double weight = 0;
    double ease = 0;  ///< millimetres, of the first
  };

  double scale_of_targets(const Part& part, const FlatState& x) const;

  FlatteningMethod method_;
  double seam_weight_ = 0;
  std::vector<std::shared_ptr<Part>> parts_;
  std::vector<PairedEdge> paired_;
};

}  // namespace bespoke
