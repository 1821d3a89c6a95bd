#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "bespoke/rbf/center_places.h"
#include "bespoke/rbf/point_grid.h"
#include "bespoke/types.h"

namespace bespoke {

/// Which of kernels.h a layer sums.
enum class Wendland { c2, c4 };

/// u(x) = Σ cⱼ φ(|x − zⱼ| / λ), prepared for blocks of nearby points.
class LayerEvaluator {
 public:
  /// centers, coefficients: 3×m, finite; lambda > 0; all mesh units. Throws InvalidInput.
  LayerEvaluator(const Points& centers, const Points& coefficients, double lambda, Wendland function);

  /// Points whose sums are formed side by side.
  static constexpr int lanes = 8;

  /// An axis-aligned box, mesh units.
  struct Bounds {
    double low[3];
    double high[3];
  };

  /// Coordinates (mesh units) and sums of `lanes` points.
  struct Block {
    double x[3][lanes];
    Bounds bounds;              ///< of x; the caller's business, by update_bounds()
    bool reached = false;       ///< whether any centre is near; the sums below are filled only then
    double value[3][lanes];     ///< u
    double gradient[9][lanes];  ///< row-major ∂uᵢ/∂xⱼ; only when requested

    void update_bounds();
  };

  /// A centre and its coefficient, mesh units.
  struct Center {
    double z[3];
    double c[3];
  };

  /// Which sums a call forms.
  enum class Order { value, gradient };

  /// Fills the sums of blocks[0 … count − 1]. `nearby` is scratch space, for reuse between calls.
  void evaluate(Block* blocks, std::size_t count, Order order, std::vector<int>& nearby) const;

  /// The same for callers that keep track of the centres near by: `candidates` holds the positions of all
  /// centres within λ of the blocks, in increasing order.
  void evaluate_among(const std::vector<int>& candidates, Block* blocks, std::size_t count, Order order,
                      std::vector<int>& nearby) const;

  /// Replaces `nearby` by the positions of the centres within λ of a box.
  void collect(const Bounds& bounds, std::vector<int>& nearby) const;

  /// The same, out of `candidates`.
  void narrow(const Bounds& bounds, const std::vector<int>& candidates, std::vector<int>& nearby) const;

  /// By position; order()[position] is the index that the constructor knew the centre by.
  const std::vector<Center>& sorted_centers() const { return sorted_; }
  const std::vector<int>& order() const { return grid_.order(); }

 private:
  void evaluate_together(Block* blocks, std::size_t count, const Bounds& bounds, Order order,
                         std::vector<int>& nearby) const;
  void evaluate_lanes(Block& block, Order order, std::vector<int>& nearby) const;
  bool within_reach(const Bounds& bounds) const;
  void sum(Block& block, Order order, const int* nearby, int count) const;
  void mark_reach(const Points& centers);

  double lambda_;
  Wendland function_;
  PointGrid grid_;
  CenterPlaces places_;         // in the grid's order
  std::vector<Center> sorted_;  // in the grid's order
  // One bit for each cell of a coarse lattice: set where a centre may lie within λ.
  std::vector<std::uint64_t> reach_;
  Vector3 reach_origin_ = Vector3::Zero();
  double reach_inverse_edge_ = 0;
  Eigen::Array3i reach_cells_ = Eigen::Array3i::Zero();
};

}  // namespace bespoke
