#include "bespoke/elastic/detail/element_distortion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "bespoke/instruction_set.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

constexpr int lanes = 8;  // cells that are evaluated side by side
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

/// The symmetric Dirichlet energy (Smith, Schaefer 2015) and the barriers of add_distortion.
struct DistortionOfPack {
  [[gnu::always_inline]] static void run(CellPack& pack, double inverse_size,
                                         const DistortionBounds& bounds) {
    const double m = bounds.min_determinant, at_rest = 1 / (1 - m), rest_slope = at_rest * at_rest;
    const double inverse_bound = 1 / bounds.max_inverse_squared;
    pack.energy.fill(0);
    pack.min_determinant.fill(infinite);
    pack.max_inverse_squared.fill(0);
    pack.stiffness.fill(0);
    for (auto& corner : pack.gradient)
      for (Lane& component : corner) component.fill(0);
    for (int corner = 0; corner < 8; ++corner) {
      std::array<std::array<Lane, 3>, 3> f;  // [component][axis]
      for (int axis = 0; axis < 3; ++axis) {
        const int bit = 4 >> axis;
        const auto& upper = pack.u[static_cast<std::size_t>(corner | bit)];
        const auto& lower = pack.u[static_cast<std::size_t>(corner & ~bit)];
        for (int i = 0; i < 3; ++i)
          for (int l = 0; l < lanes; ++l)
            f[i][axis][l] = (upper[i][l] - lower[i][l]) * inverse_size + (i == axis);
      }
      std::array<std::array<Lane, 3>, 3> p;
      for (int l = 0; l < lanes; ++l) {
        const double a = f[0][0][l], b = f[0][1][l], c = f[0][2][l], d = f[1][0][l], e = f[1][1][l],
                     g = f[1][2][l], h = f[2][0][l], i = f[2][1][l], j = f[2][2][l];
        // Cofactors: their matrix over the determinant is F⁻ᵀ.
        double k00 = e * j - g * i, k01 = g * h - d * j, k02 = d * i - e * h;
        double k10 = c * i - b * j, k11 = a * j - c * h, k12 = b * h - a * i;
        double k20 = b * g - c * e, k21 = c * d - a * g, k22 = a * e - b * d;
        const double determinant = a * k00 + b * k01 + c * k02;
        const double inverse = 1 / determinant;
        k00 *= inverse, k01 *= inverse, k02 *= inverse, k10 *= inverse, k11 *= inverse, k12 *= inverse;
        k20 *= inverse, k21 *= inverse, k22 *= inverse;
        const double squared = a * a + b * b + c * c + d * d + e * e + g * g + h * h + i * i + j * j;
        const double inverse_squared = k00 * k00 + k01 * k01 + k02 * k02 + k10 * k10 + k11 * k11 + k12 * k12 +
                                       k20 * k20 + k21 * k21 + k22 * k22;
        const double above = 1 / (determinant - m);
        const double y = inverse_squared * inverse_bound, below = 1 / (1 - y);
        pack.energy[l] += (squared + inverse_squared) / 2 - 3 +
                          m * (above - at_rest + (determinant - 1) * rest_slope) + y * y * below;
        pack.min_determinant[l] =
            determinant < pack.min_determinant[l] ? determinant : pack.min_determinant[l];
        pack.max_inverse_squared[l] =
            inverse_squared > pack.max_inverse_squared[l] ? inverse_squared : pack.max_inverse_squared[l];
        // Second derivatives along the shortest length: of |F|²/2 + |F⁻¹|²/2, of the barriers.
        const double shortest = inverse_squared - 2;
        pack.stiffness[l] += 1 + 3 * shortest * shortest +
                             2 * m * above * above * above * determinant * determinant * inverse_squared +
                             8 * inverse_squared * y * y * below * below * below;
        // dJ/dF = J G, and ds/dF = −2 G Gᵀ G.
        const double v = m * (rest_slope - above * above) * determinant;
        const double q = 1 + 2 * inverse_bound * y * (2 - y) * below * below;
        // G Gᵀ G with G = F⁻ᵀ: minus the gradient of |F⁻¹|²/2.
        const double s00 = k00 * k00 + k01 * k01 + k02 * k02, s01 = k00 * k10 + k01 * k11 + k02 * k12,
                     s02 = k00 * k20 + k01 * k21 + k02 * k22, s11 = k10 * k10 + k11 * k11 + k12 * k12,
                     s12 = k10 * k20 + k11 * k21 + k12 * k22, s22 = k20 * k20 + k21 * k21 + k22 * k22;
        p[0][0][l] = a + v * k00 - q * (s00 * k00 + s01 * k10 + s02 * k20);
        p[0][1][l] = b + v * k01 - q * (s00 * k01 + s01 * k11 + s02 * k21);
        p[0][2][l] = c + v * k02 - q * (s00 * k02 + s01 * k12 + s02 * k22);
        p[1][0][l] = d + v * k10 - q * (s01 * k00 + s11 * k10 + s12 * k20);
        p[1][1][l] = e + v * k11 - q * (s01 * k01 + s11 * k11 + s12 * k21);
        p[1][2][l] = g + v * k12 - q * (s01 * k02 + s11 * k12 + s12 * k22);
        p[2][0][l] = h + v * k20 - q * (s02 * k00 + s12 * k10 + s22 * k20);
        p[2][1][l] = i + v * k21 - q * (s02 * k01 + s12 * k11 + s22 * k21);
        p[2][2][l] = j + v * k22 - q * (s02 * k02 + s12 * k12 + s22 * k22);
      }
      for (int axis = 0; axis < 3; ++axis) {
        const int bit = 4 >> axis;
        auto& upper = pack.gradient[static_cast<std::size_t>(corner | bit)];
        auto& lower = pack.gradient[static_cast<std::size_t>(corner & ~bit)];
        for (int i = 0; i < 3; ++i)
          for (int l = 0; l < lanes; ++l) {
            upper[i][l] += p[i][axis][l];
            lower[i][l] -= p[i][axis][l];
          }
      }
    }
  }
};

/// The least Bézier coefficient of det F over each cell (Johnen, Weill and Remacle 2017). F's column of an
/// axis is bilinear in the two others, so a coefficient is a sum of triple products of the cell's edges.
struct MinCoefficientOfPack {
  [[gnu::always_inline]] static void run(const CornerVectors& u, double inverse_size, Lane& result) {
    using Edges = std::array<std::array<Lane, 3>, 4>;  // of an axis, by the bits of the two others
    const auto edges_along = [&](int axis) {
      const int bit = 4 >> axis, first = axis == 0 ? 2 : 4, second = axis == 2 ? 2 : 1;
      Edges edges;
      for (int k = 0; k < 4; ++k) {
        const auto lower = static_cast<std::size_t>((k & 2 ? first : 0) | (k & 1 ? second : 0));
        for (int i = 0; i < 3; ++i)
          for (int l = 0; l < lanes; ++l)
            edges[k][i][l] =
                (u[lower | static_cast<std::size_t>(bit)][i][l] - u[lower][i][l]) * inverse_size +
                (i == axis);
      }
      return edges;
    };
    const Edges x = edges_along(0), y = edges_along(1), z = edges_along(2);
    std::array<Lane, 27> coefficients{};
    for (int yz = 0; yz < 4; ++yz)
      for (int xz = 0; xz < 4; ++xz) {
        std::array<Lane, 3> normal;
        for (int i = 0; i < 3; ++i)
          for (int l = 0; l < lanes; ++l)
            normal[i][l] =
                x[yz][(i + 1) % 3][l] * y[xz][(i + 2) % 3][l] - x[yz][(i + 2) % 3][l] * y[xz][(i + 1) % 3][l];
        for (int xy = 0; xy < 4; ++xy) {
          const int i = (xz >> 1) + (xy >> 1), j = (yz >> 1) + (xy & 1), k = (yz & 1) + (xz & 1);
          const double share = (i == 1 ? 0.5 : 1) * (j == 1 ? 0.5 : 1) * (k == 1 ? 0.5 : 1);
          Lane& coefficient = coefficients[static_cast<std::size_t>(9 * i + 3 * j + k)];
          for (int l = 0; l < lanes; ++l)
            coefficient[l] += share * (normal[0][l] * z[xy][0][l] + normal[1][l] * z[xy][1][l] +
                                       normal[2][l] * z[xy][2][l]);
        }
      }
    result = coefficients[0];
    for (const Lane& coefficient : coefficients)
      for (int l = 0; l < lanes; ++l) result[l] = coefficient[l] < result[l] ? coefficient[l] : result[l];
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
  run_dispatched<DistortionOfPack>(pack, 1 / level.voxel_size, bounds);
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
  run_dispatched<MinCoefficientOfPack>(pack.u, inverse_size, coefficient);
  for (std::size_t l = 0; l < count; ++l)
    if (!(coefficient[l] > bounds.min_determinant)) beyond |= 1U << l;
  return beyond;
}

constexpr std::size_t packs_per_task = 64;

// Of the bound on J: that of its Bézier coefficients, which are below it.
constexpr double coefficient_share = 0.1;

/// Of one level; `cell_gradients`: 24 numbers a finest cell.
Distortion evaluate_level(const ElementLevel& level, const Points& values, const DistortionBounds& bounds,
                          std::vector<double>& cell_gradients, std::vector<double>& stiffness) {
  const double h = level.voxel_size, volume = h * h * h / 8, area = h * h / 8;
  const std::size_t count = level.finest.size();
  cell_gradients.resize(24 * count);
  stiffness.resize(count);
  const auto partial = [&](std::size_t begin, std::size_t end) {
    Distortion part;
    CellPack pack;
    for (std::size_t first = begin; first < end; first += lanes) {
      evaluate(level, values, bounds, first, pack);
      const std::size_t filled = std::min<std::size_t>(lanes, end - first);
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
  return parallel_reduce(
      count, packs_per_task * lanes, Distortion{}, partial, [](const Distortion& a, const Distortion& b) {
        return Distortion{a.energy + b.energy, std::min(a.min_determinant, b.min_determinant), {}};
      });
}

}  // namespace

Distortion add_distortion(const NestedElements& elements, const std::vector<Points>& values,
                          const DistortionBounds& bounds, std::vector<Points>& gradients) {
  Distortion whole;
  whole.stiffness.resize(elements.levels().size());
  std::vector<double> cell_gradients;
  for (std::size_t k = 0; k < elements.levels().size(); ++k) {
    const ElementLevel& level = elements.levels()[k];
    const Distortion part = evaluate_level(level, values[k], bounds, cell_gradients, whole.stiffness[k]);
    whole.energy += part.energy;
    whole.min_determinant = std::min(whole.min_determinant, part.min_determinant);
    if (!std::isfinite(whole.energy)) continue;
    parallel_for(level.points.size(), 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p < end; ++p)
        for (int q = level.incident_begin[p]; q < level.incident_begin[p + 1]; ++q) {
          const double* from = cell_gradients.data() + 3 * level.incident[static_cast<std::size_t>(q)];
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
      run_dispatched<MinCoefficientOfPack>(pack.u, 1 / level.voxel_size, coefficient);
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
