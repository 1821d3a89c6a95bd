#include "bespoke/elastic/detail/element_distortion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "bespoke/instruction_set.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

constexpr std::size_t lanes = 8;  // cells that are evaluated side by side
using Lane = std::array<double, lanes>;

/// u at the eight corners of `lanes` cells, or the energy's gradient there.
using CornerVectors = std::array<std::array<Lane, 3>, 8>;

struct CellPack {
  CornerVectors u;
  CornerVectors gradient;
  Lane energy;  ///< summed over the corners, per volume
  Lane min_determinant;
  Lane max_inverse_squared;
  Lane stiffness;  ///< summed over the corners, no unit
};

/// As many numbers as the machine computes at once. GCC makes loops over arrays of arrays into vectors in
/// part only, so they are written down; a function that took one would have another ABI per instruction set.
template <InstructionSet Set>
struct Vectors {
  static constexpr std::size_t width = Set == InstructionSet::avx512 ? 8
                                       : Set == InstructionSet::avx2 ? 4
                                                                     : 2;
  typedef double type __attribute__((vector_size(width * sizeof(double))));
};

/// (u at the upper end − u at the lower end)/h + e_axis of the four edges along an axis, by the bits of the
/// two other axes: columns of F at the ends.
template <class Vector>
using Edges = std::array<std::array<Vector, 3>, 4>;

/// The lower end of an edge.
constexpr std::size_t lower_end(std::size_t axis, std::size_t edge) {
  const std::size_t first = axis == 0 ? 2 : 4, second = axis == 2 ? 2 : 1;
  return (edge & 2 ? first : 0) | (edge & 1 ? second : 0);
}

/// The edge along an axis that ends at a corner.
constexpr std::size_t edge_at(std::size_t axis, std::size_t corner) {
  const std::size_t first = axis == 0 ? 2 : 4, second = axis == 2 ? 2 : 1;
  return (corner & first ? 2 : 0) | (corner & second ? 1 : 0);
}

template <class Vector>
[[gnu::always_inline]] inline void read_edges(const CornerVectors& u, std::size_t from, double inverse_size,
                                              std::array<Edges<Vector>, 3>& edges) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t edge = 0; edge < 4; ++edge)
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t lower = lower_end(axis, edge);
        Vector at_lower, at_upper;
        std::memcpy(&at_lower, u[lower][i].data() + from, sizeof(Vector));
        std::memcpy(&at_upper, u[lower | (4U >> axis)][i].data() + from, sizeof(Vector));
        edges[axis][edge][i] = (at_upper - at_lower) * inverse_size + (i == axis ? 1.0 : 0.0);
      }
}

/// The symmetric Dirichlet energy (Smith, Schaefer 2015) and the barriers of add_distortion.
template <InstructionSet Set>
struct DistortionOfPack {
  using Vector = typename Vectors<Set>::type;

  [[gnu::always_inline]] static void run(CellPack& pack, double inverse_size,
                                         const DistortionBounds& bounds) {
    for (std::size_t from = 0; from < lanes; from += Vectors<Set>::width)
      part(pack, from, inverse_size, bounds);
  }

  [[gnu::always_inline]] static void part(CellPack& pack, std::size_t from, double inverse_size,
                                          const DistortionBounds& bounds) {
    const double m = bounds.min_determinant, at_rest = 1 / (1 - m), rest_slope = at_rest * at_rest;
    const double inverse_bound = 1 / bounds.max_inverse_squared;
    std::array<Edges<Vector>, 3> edges, slopes;  // slopes: of the energy, with respect to the edges
    read_edges(pack.u, from, inverse_size, edges);
    for (auto& of_axis : slopes)
      for (auto& of_edge : of_axis) of_edge = {Vector{}, Vector{}, Vector{}};
    Vector energy{}, stiffness{}, largest{}, least = Vector{} + infinite;
    for (std::size_t corner = 0; corner < 8; ++corner) {
      const auto& x = edges[0][edge_at(0, corner)];
      const auto& y = edges[1][edge_at(1, corner)];
      const auto& z = edges[2][edge_at(2, corner)];
      const Vector a = x[0], b = y[0], c = z[0], d = x[1], e = y[1], g = z[1], h = x[2], i = y[2], j = z[2];
      // Cofactors: their matrix over the determinant is F⁻ᵀ.
      Vector k00 = e * j - g * i, k01 = g * h - d * j, k02 = d * i - e * h;
      Vector k10 = c * i - b * j, k11 = a * j - c * h, k12 = b * h - a * i;
      Vector k20 = b * g - c * e, k21 = c * d - a * g, k22 = a * e - b * d;
      const Vector determinant = a * k00 + b * k01 + c * k02;
      const Vector inverse = 1 / determinant;
      k00 *= inverse, k01 *= inverse, k02 *= inverse, k10 *= inverse, k11 *= inverse, k12 *= inverse;
      k20 *= inverse, k21 *= inverse, k22 *= inverse;
      // G Gᵀ with G = F⁻ᵀ.
      const Vector s00 = k00 * k00 + k01 * k01 + k02 * k02, s01 = k00 * k10 + k01 * k11 + k02 * k12,
                   s02 = k00 * k20 + k01 * k21 + k02 * k22, s11 = k10 * k10 + k11 * k11 + k12 * k12,
                   s12 = k10 * k20 + k11 * k21 + k12 * k22, s22 = k20 * k20 + k21 * k21 + k22 * k22;
      const Vector squared = a * a + b * b + c * c + d * d + e * e + g * g + h * h + i * i + j * j;
      const Vector inverse_squared = s00 + s11 + s22;
      const Vector above = 1 / (determinant - m);
      const Vector share = inverse_squared * inverse_bound, below = 1 / (1 - share);
      energy += (squared + inverse_squared) / 2 - 3 + m * (above - at_rest + (determinant - 1) * rest_slope) +
                share * share * below;
      least = determinant < least ? determinant : least;
      largest = inverse_squared > largest ? inverse_squared : largest;
      // Second derivatives along the shortest length: of |F|²/2 + |F⁻¹|²/2, of the barriers.
      const Vector shortest = inverse_squared - 2;
      stiffness += 1 + 3 * shortest * shortest +
                   2 * m * above * above * above * determinant * determinant * inverse_squared +
                   8 * inverse_squared * share * share * below * below * below;
      // dJ/dF = J G, and ds/dF = −2 G Gᵀ G.
      const Vector v = m * (rest_slope - above * above) * determinant;
      const Vector q = 1 + 2 * inverse_bound * share * (2 - share) * below * below;
      auto& of_x = slopes[0][edge_at(0, corner)];
      auto& of_y = slopes[1][edge_at(1, corner)];
      auto& of_z = slopes[2][edge_at(2, corner)];
      of_x[0] += a + v * k00 - q * (s00 * k00 + s01 * k10 + s02 * k20);
      of_y[0] += b + v * k01 - q * (s00 * k01 + s01 * k11 + s02 * k21);
      of_z[0] += c + v * k02 - q * (s00 * k02 + s01 * k12 + s02 * k22);
      of_x[1] += d + v * k10 - q * (s01 * k00 + s11 * k10 + s12 * k20);
      of_y[1] += e + v * k11 - q * (s01 * k01 + s11 * k11 + s12 * k21);
      of_z[1] += g + v * k12 - q * (s01 * k02 + s11 * k12 + s12 * k22);
      of_x[2] += h + v * k20 - q * (s02 * k00 + s12 * k10 + s22 * k20);
      of_y[2] += i + v * k21 - q * (s02 * k01 + s12 * k11 + s22 * k21);
      of_z[2] += j + v * k22 - q * (s02 * k02 + s12 * k12 + s22 * k22);
    }
    std::memcpy(pack.energy.data() + from, &energy, sizeof energy);
    std::memcpy(pack.stiffness.data() + from, &stiffness, sizeof stiffness);
    std::memcpy(pack.min_determinant.data() + from, &least, sizeof least);
    std::memcpy(pack.max_inverse_squared.data() + from, &largest, sizeof largest);
    for (std::size_t corner = 0; corner < 8; ++corner)
      for (std::size_t i = 0; i < 3; ++i) {
        Vector sum{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const Vector& slope = slopes[axis][edge_at(axis, corner)][i];
          if (corner & (4U >> axis))
            sum += slope;
          else
            sum -= slope;
        }
        std::memcpy(pack.gradient[corner][i].data() + from, &sum, sizeof sum);
      }
  }
};

/// The least Bézier coefficient of det F over each cell (Johnen, Weill and Remacle 2017). F's column of an
/// axis is bilinear in the two others, so a coefficient is a sum of triple products of the cell's edges.
template <InstructionSet Set>
struct MinCoefficientOfPack {
  using Vector = typename Vectors<Set>::type;

  [[gnu::always_inline]] static void run(const CornerVectors& u, double inverse_size, Lane& result) {
    for (std::size_t from = 0; from < lanes; from += Vectors<Set>::width) part(u, from, inverse_size, result);
  }

  [[gnu::always_inline]] static void part(const CornerVectors& u, std::size_t from, double inverse_size,
                                          Lane& result) {
    std::array<Edges<Vector>, 3> edges;
    read_edges(u, from, inverse_size, edges);
    std::array<Vector, 27> coefficients{};
    for (std::size_t yz = 0; yz < 4; ++yz)
      for (std::size_t xz = 0; xz < 4; ++xz) {
        const auto& x = edges[0][yz];
        const auto& y = edges[1][xz];
        const Vector n0 = x[1] * y[2] - x[2] * y[1], n1 = x[2] * y[0] - x[0] * y[2],
                     n2 = x[0] * y[1] - x[1] * y[0];
        for (std::size_t xy = 0; xy < 4; ++xy) {
          const auto& z = edges[2][xy];
          const std::size_t i = (xz >> 1) + (xy >> 1), j = (yz >> 1) + (xy & 1), k = (yz & 1) + (xz & 1);
          const double share = (i == 1 ? 0.5 : 1) * (j == 1 ? 0.5 : 1) * (k == 1 ? 0.5 : 1);
          coefficients[9 * i + 3 * j + k] += share * (n0 * z[0] + n1 * z[1] + n2 * z[2]);
        }
      }
    Vector least = coefficients[0];
    for (const Vector& coefficient : coefficients) least = coefficient < least ? coefficient : least;
    std::memcpy(result.data() + from, &least, sizeof least);
  }
};

/// The cells of a pack; the last is repeated where there are fewer.
std::size_t cell_of_lane(std::size_t first, std::size_t lane, std::size_t count) {
  return std::min(first + lane, count - 1);
}

void gather(const ElementLevel& level, const Points& values, std::size_t first, CellPack& pack) {
  for (std::size_t l = 0; l < lanes; ++l) {
    const int cell = level.finest[cell_of_lane(first, l, level.finest.size())];
    const std::array<int, 8>& corners = level.corners[static_cast<std::size_t>(cell)];
    for (std::size_t corner = 0; corner < 8; ++corner) {
      const double* value = values.col(corners[corner]).data();
      for (std::size_t i = 0; i < 3; ++i) pack.u[corner][i][l] = value[i];
    }
  }
}

/// Fills the pack with finest cells from `first` on and evaluates them.
void evaluate(const ElementLevel& level, const Points& values, const DistortionBounds& bounds,
              std::size_t first, CellPack& pack) {
  gather(level, values, first, pack);
  run_dispatched_by_set<DistortionOfPack>(pack, 1 / level.voxel_size, bounds);
}

/// Which of the first `count` cells of a pack are not within the bounds; bits.
unsigned beyond_bounds(const CellPack& pack, std::size_t count, double inverse_size,
                       const DistortionBounds& bounds) {
  // Summed over eight corners: cells of less energy keep their volume to two thirds at least.
  constexpr double safe_energy = 0.5;
  bool safe = true;
  unsigned beyond = 0;
  for (std::size_t l = 0; l < count; ++l) {
    if (!(pack.min_determinant[l] > bounds.min_determinant) ||
        !(pack.max_inverse_squared[l] < bounds.max_inverse_squared))
      beyond |= 1U << l;
    safe = safe && pack.energy[l] < safe_energy;
  }
  if (safe && beyond == 0) return 0;
  Lane coefficient;
  run_dispatched_by_set<MinCoefficientOfPack>(pack.u, inverse_size, coefficient);
  for (std::size_t l = 0; l < count; ++l)
    if (!(coefficient[l] > bounds.min_determinant)) beyond |= 1U << l;
  return beyond;
}

constexpr std::size_t packs_per_task = 64;

// Of the bound on J: that of its Bézier coefficients, which are below it.
constexpr double coefficient_share = 0.1;

struct Part {
  double energy = 0;
  double min_determinant = infinite;
};

/// Of one level; `cell_gradients`: 24 numbers a finest cell, and perhaps more behind them.
Part evaluate_level(const ElementLevel& level, const Points& values, const DistortionBounds& bounds,
                    std::vector<double>& cell_gradients, std::vector<double>& stiffness) {
  const double h = level.voxel_size, volume = h * h * h / 8, area = h * h / 8;
  const std::size_t count = level.finest.size();
  if (cell_gradients.size() < 24 * count) cell_gradients.resize(24 * count);
  stiffness.resize(count);
  const auto partial = [&](std::size_t begin, std::size_t end) {
    Part part;
    CellPack pack;
    for (std::size_t first = begin; first < end; first += lanes) {
      evaluate(level, values, bounds, first, pack);
      const std::size_t filled = std::min(lanes, end - first);
      if (const unsigned beyond = beyond_bounds(pack, filled, 1 / h, bounds)) {
        part.energy = infinite;
        for (std::size_t l = 0; l < filled; ++l) stiffness[first + l] = (beyond >> l) & 1 ? infinite : 0;
        continue;
      }
      for (std::size_t l = 0; l < filled; ++l) {
        const double weight = level.weights[first + l];
        part.energy += weight * volume * pack.energy[l];
        stiffness[first + l] = weight * pack.stiffness[l] / 8;
        part.min_determinant = std::min(part.min_determinant, pack.min_determinant[l]);
        double* gradient = cell_gradients.data() + 24 * (first + l);
        for (std::size_t corner = 0; corner < 8; ++corner)
          for (std::size_t i = 0; i < 3; ++i) *gradient++ = weight * area * pack.gradient[corner][i][l];
      }
    }
    return part;
  };
  return parallel_reduce(count, packs_per_task * lanes, Part{}, partial, [](const Part& a, const Part& b) {
    return Part{a.energy + b.energy, std::min(a.min_determinant, b.min_determinant)};
  });
}

}  // namespace

Distortion add_distortion(const NestedElements& elements, const std::vector<Points>& values,
                          const DistortionBounds& bounds, std::vector<Points>& gradients,
                          std::vector<double>& scratch) {
  Distortion whole;
  whole.stiffness.resize(elements.levels().size());
  for (std::size_t k = 0; k < elements.levels().size(); ++k) {
    const ElementLevel& level = elements.levels()[k];
    const Part part = evaluate_level(level, values[k], bounds, scratch, whole.stiffness[k]);
    whole.energy += part.energy;
    whole.min_determinant = std::min(whole.min_determinant, part.min_determinant);
    if (!std::isfinite(whole.energy)) continue;
    parallel_for(level.points.size(), 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p < end; ++p)
        for (int q = level.incident_begin[p]; q < level.incident_begin[p + 1]; ++q) {
          const double* from = scratch.data() + 3 * level.incident[static_cast<std::size_t>(q)];
          for (int i = 0; i < 3; ++i) gradients[k](i, static_cast<Eigen::Index>(p)) += from[i];
        }
    });
  }
  return whole;
}

std::vector<std::vector<std::size_t>> cells_beyond(const NestedElements& elements,
                                                   const std::vector<Points>& values,
                                                   const DistortionBounds& bounds) {
  std::vector<std::vector<std::size_t>> beyond(elements.levels().size());
  CellPack pack;
  for (std::size_t k = 0; k < elements.levels().size(); ++k) {
    const ElementLevel& level = elements.levels()[k];
    for (std::size_t first = 0; first < level.finest.size(); first += lanes) {
      evaluate(level, values[k], bounds, first, pack);
      Lane coefficient;
      run_dispatched_by_set<MinCoefficientOfPack>(pack.u, 1 / level.voxel_size, coefficient);
      for (std::size_t l = 0; l < lanes && first + l < level.finest.size(); ++l)
        if (!(pack.min_determinant[l] >= bounds.min_determinant &&
              pack.max_inverse_squared[l] <= bounds.max_inverse_squared &&
              coefficient[l] >= coefficient_share * bounds.min_determinant))
          beyond[k].push_back(first + l);
    }
  }
  return beyond;
}

std::vector<std::vector<double>> distortion_diagonal(const NestedElements& elements,
                                                     const std::vector<std::vector<double>>& of_finest) {
  const std::vector<ElementLevel>& levels = elements.levels();
  // Of a cell; of one that is split the mean of its parts.
  std::vector<std::vector<double>> stiffness(levels.size()), diagonal(levels.size());
  for (std::size_t k = levels.size(); k-- > 0;) {
    const ElementLevel& level = levels[k];
    stiffness[k].assign(level.cells.size(), 0);
    for (std::size_t number = 0; number < level.finest.size(); ++number)
      stiffness[k][static_cast<std::size_t>(level.finest[number])] = of_finest[k][number];
    for (std::size_t c = 0; k + 1 < levels.size() && c < level.cells.size(); ++c) {
      const int child = level.first_part[c];
      if (child == no_leaf) continue;
      double sum = 0;
      for (int octant = 0; octant < 8; ++octant)
        sum += stiffness[k + 1][static_cast<std::size_t>(child + octant)];
      stiffness[k][c] = sum / 8;
    }
    diagonal[k].assign(level.points.size(), 0);
    // ∫ |∇|² of a hat function by corner quadrature is 6 h, from eight cells.
    for (std::size_t c = 0; c < level.cells.size(); ++c)
      for (const int corner : level.corners[c])
        diagonal[k][static_cast<std::size_t>(corner)] += 0.75 * level.voxel_size * stiffness[k][c];
  }
  return diagonal;
}

}  // namespace bespoke
