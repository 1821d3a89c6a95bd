#include "bespoke/elastic/detail/element_distortion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "bespoke/instruction_set.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

constexpr int lanes = 8;  // cells that are evaluated side by side
using Lane = std::array<double, lanes>;

/// u at the eight corners of `lanes` cells, or the energy's gradient there.
using CornerVectors = std::array<std::array<Lane, 3>, 8>;

struct CellPack {
  CornerVectors u;
  CornerVectors gradient;
  Lane energy;           ///< per volume
  Lane min_determinant;
};

struct DistortionOfPack {
  [[gnu::always_inline]] static void run(CellPack& pack, double inverse_size) {
    pack.energy.fill(0);
    pack.min_determinant.fill(std::numeric_limits<double>::infinity());
    for (auto& corner : pack.gradient)
      for (Lane& component : corner) component.fill(0);
    for (int corner = 0; corner < 8; ++corner) {
      std::array<std::array<Lane, 3>, 3> f;  // [component][axis]
      for (int axis = 0; axis < 3; ++axis) {
        const int bit = 4 >> axis;
        const auto& upper = pack.u[static_cast<std::size_t>(corner | bit)];
        const auto& lower = pack.u[static_cast<std::size_t>(corner & ~bit)];
        for (int i = 0; i < 3; ++i)
          for (int l = 0; l < lanes; ++l) f[i][axis][l] = (upper[i][l] - lower[i][l]) * inverse_size + (i == axis);
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
        pack.energy[l] += (squared + inverse_squared) / 2 - 3;
        pack.min_determinant[l] = determinant < pack.min_determinant[l] ? determinant : pack.min_determinant[l];
        // G Gᵀ G with G = F⁻ᵀ: minus the gradient of |F⁻¹|²/2.
        const double s00 = k00 * k00 + k01 * k01 + k02 * k02, s01 = k00 * k10 + k01 * k11 + k02 * k12,
                     s02 = k00 * k20 + k01 * k21 + k02 * k22, s11 = k10 * k10 + k11 * k11 + k12 * k12,
                     s12 = k10 * k20 + k11 * k21 + k12 * k22, s22 = k20 * k20 + k21 * k21 + k22 * k22;
        p[0][0][l] = a - (s00 * k00 + s01 * k10 + s02 * k20);
        p[0][1][l] = b - (s00 * k01 + s01 * k11 + s02 * k21);
        p[0][2][l] = c - (s00 * k02 + s01 * k12 + s02 * k22);
        p[1][0][l] = d - (s01 * k00 + s11 * k10 + s12 * k20);
        p[1][1][l] = e - (s01 * k01 + s11 * k11 + s12 * k21);
        p[1][2][l] = g - (s01 * k02 + s11 * k12 + s12 * k22);
        p[2][0][l] = h - (s02 * k00 + s12 * k10 + s22 * k20);
        p[2][1][l] = i - (s02 * k01 + s12 * k11 + s22 * k21);
        p[2][2][l] = j - (s02 * k02 + s12 * k12 + s22 * k22);
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

/// Whether all Bézier coefficients of det F over a lane's cell are positive (Johnen, Weill and Remacle 2017).
bool keeps_orientation(const CornerVectors& u, std::size_t lane, double inverse_size) {
  // F's column of an axis is bilinear in the two others: its four values, by the bits of these.
  std::array<std::array<Vector3, 4>, 3> edge;
  for (int axis = 0; axis < 3; ++axis) {
    const int bit = 4 >> axis, first = axis == 0 ? 2 : 4, second = axis == 2 ? 2 : 1;
    for (int k = 0; k < 4; ++k) {
      const int lower = (k & 2 ? first : 0) | (k & 1 ? second : 0);
      for (int i = 0; i < 3; ++i) {
        const auto c = static_cast<std::size_t>(i);
        edge[static_cast<std::size_t>(axis)][static_cast<std::size_t>(k)][i] =
            (u[static_cast<std::size_t>(lower | bit)][c][lane] - u[static_cast<std::size_t>(lower)][c][lane]) *
                inverse_size +
            (i == axis);
      }
    }
  }
  std::array<double, 27> coefficients{};
  for (int yz = 0; yz < 4; ++yz)
    for (int xz = 0; xz < 4; ++xz) {
      const Vector3 normal = edge[0][static_cast<std::size_t>(yz)].cross(edge[1][static_cast<std::size_t>(xz)]);
      for (int xy = 0; xy < 4; ++xy) {
        const int i = (xz >> 1) + (xy >> 1), j = (yz >> 1) + (xy & 1), k = (yz & 1) + (xz & 1);
        const double share = (i == 1 ? 0.5 : 1) * (j == 1 ? 0.5 : 1) * (k == 1 ? 0.5 : 1);
        coefficients[static_cast<std::size_t>(9 * i + 3 * j + k)] +=
            share * normal.dot(edge[2][static_cast<std::size_t>(xy)]);
      }
    }
  return std::all_of(coefficients.begin(), coefficients.end(), [](double c) { return c > 0; });
}

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

}  // namespace

Distortion add_distortion(const NestedElements& elements, const std::vector<Points>& values,
                          std::vector<Points>& gradients) {
  Distortion whole{0, std::numeric_limits<double>::infinity()};
  for (std::size_t k = 0; k < elements.levels().size(); ++k) {
    const ElementLevel& level = elements.levels()[k];
    const double h = level.voxel_size, weight = h * h * h / 8;
    const std::size_t count = level.finest.size();
    CellPack pack;
    for (std::size_t first = 0; first < count; first += lanes) {
      gather(level, values[k], first, pack);
      run_dispatched<DistortionOfPack>(pack, 1 / h);
      for (std::size_t l = 0; l < lanes && first + l < count; ++l) {
        // Cells whose energy is small are far from turning over anywhere.
        constexpr double safe_energy = 8 * 0.5;
        if (!(pack.min_determinant[l] > 0) ||
            (pack.energy[l] > safe_energy && !keeps_orientation(pack.u, l, 1 / h)))
          return {std::numeric_limits<double>::infinity(), 0};
        whole.energy += weight * pack.energy[l];
        whole.min_determinant = std::min(whole.min_determinant, pack.min_determinant[l]);
        const std::array<int, 8>& corners = level.corners[static_cast<std::size_t>(level.finest[first + l])];
        for (std::size_t corner = 0; corner < 8; ++corner) {
          double* gradient = gradients[k].col(corners[corner]).data();
          for (std::size_t i = 0; i < 3; ++i) gradient[i] += weight / h * pack.gradient[corner][i][l];
        }
      }
    }
  }
  return whole;
}

std::vector<std::vector<double>> distortion_diagonal(const NestedElements& elements,
                                                     const std::vector<Points>& values) {
  const std::vector<ElementLevel>& levels = elements.levels();
  // How stiff a cell is against one that is at rest: of a split cell the mean of its parts.
  std::vector<std::vector<double>> stiffness(levels.size());
  std::vector<std::vector<double>> diagonal(levels.size());
  for (std::size_t k = levels.size(); k-- > 0;) {
    const ElementLevel& level = levels[k];
    stiffness[k].assign(level.cells.size(), 0);
    CellPack pack;
    for (std::size_t first = 0; first < level.finest.size(); first += lanes) {
      gather(level, values[k], first, pack);
      run_dispatched<DistortionOfPack>(pack, 1 / level.voxel_size);
      for (std::size_t l = 0; l < lanes && first + l < level.finest.size(); ++l) {
        const double w = 1 + pack.energy[l] / 8;  // grows as |F⁻¹|², the stiffness as its square
        stiffness[k][static_cast<std::size_t>(level.finest[first + l])] = 2 * w * w;
      }
    }
    if (k + 1 < levels.size())
      for (std::size_t c = 0; c < level.cells.size(); ++c) {
        double sum = 0;
        const int child = levels[k + 1].cell_table.find(child_of(level.cells[c], 0));
        if (child == no_leaf) continue;
        for (int octant = 0; octant < 8; ++octant)
          sum += stiffness[k + 1][static_cast<std::size_t>(child + octant)];
        stiffness[k][c] = sum / 8;
      }
    diagonal[k].assign(level.points.size(), 0);
    // |∇|² of a hat function by corner quadrature: six edges of h each, four cells around each edge.
    for (std::size_t c = 0; c < level.cells.size(); ++c)
      for (const int corner : level.corners[c])
        diagonal[k][static_cast<std::size_t>(corner)] += 0.75 * level.voxel_size * stiffness[k][c];
  }
  return diagonal;
}

}  // namespace bespoke
