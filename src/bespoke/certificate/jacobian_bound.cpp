#include "bespoke/certificate/jacobian_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "bespoke/instruction_set.h"

namespace bespoke {
namespace {

constexpr double unit_roundoff = 0x1p-53;
constexpr int plane = block_edge * block_edge;

// Cells of one row (fixed i, j; k = 0 … 7) at a time: the innermost loops run over them.
constexpr int lanes = leaf_edge;
using Row = std::array<double, lanes>;
using RowVector = std::array<Row, 3>;

// Columns of the Jacobian along one axis at the four edges of each cell of a row, divided by the voxel size.
using Edges = std::array<RowVector, 4>;

struct EdgeNodes {
  int lower, upper;  // of the first cell of the row
};

inline void subtract_nodes(const NodeBlock& sum, EdgeNodes nodes, const Vector3& column, double scale,
                           RowVector& edge) {
  for (int c = 0; c < 3; ++c) {
    const double* lower = sum[c].data() + nodes.lower;
    const double* upper = sum[c].data() + nodes.upper;
    for (int n = 0; n < lanes; ++n) edge[c][n] = column[c] + scale * (upper[n] - lower[n]);
  }
}

inline void cross(const RowVector& a, const RowVector& b, RowVector& result) {
  for (int n = 0; n < lanes; ++n) {
    result[0][n] = a[1][n] * b[2][n] - a[2][n] * b[1][n];
    result[1][n] = a[2][n] * b[0][n] - a[0][n] * b[2][n];
    result[2][n] = a[0][n] * b[1][n] - a[1][n] * b[0][n];
  }
}

inline void half_sum_of_crosses(const RowVector& a, const RowVector& b, const RowVector& c,
                                const RowVector& d, RowVector& result) {
  for (int n = 0; n < lanes; ++n) {
    result[0][n] = 0.5 * (a[1][n] * b[2][n] - a[2][n] * b[1][n] + c[1][n] * d[2][n] - c[2][n] * d[1][n]);
    result[1][n] = 0.5 * (a[2][n] * b[0][n] - a[0][n] * b[2][n] + c[2][n] * d[0][n] - c[0][n] * d[2][n]);
    result[2][n] = 0.5 * (a[0][n] * b[1][n] - a[1][n] * b[0][n] + c[0][n] * d[1][n] - c[1][n] * d[0][n]);
  }
}

inline void dot(const RowVector& a, const RowVector& b, Row& result) {
  for (int n = 0; n < lanes; ++n) result[n] = a[0][n] * b[0][n] + a[1][n] * b[1][n] + a[2][n] * b[2][n];
}

// The 27 coefficients of a row of cells. det = X(y,z)·(Y(x,z) × Z(x,y)), each factor bilinear, so a
// coefficient of degree 2 along an axis is the mean over the ways to share its index between the two factors.
struct RowCoefficients {
  std::array<Row, 27> values;

  [[gnu::always_inline]] inline void compute(const NodeBlock& sum, int node, const Matrix3& linear,
                                             double scale) {
    Edges x, y, z;
    for (int first = 0; first < 2; ++first)
      for (int second = 0; second < 2; ++second) {
        const int e = 2 * first + second;
        const int of_x = node + first * block_edge + second;
        subtract_nodes(sum, {of_x, of_x + plane}, linear.col(0), scale, x[e]);
        const int of_y = node + first * plane + second;
        subtract_nodes(sum, {of_y, of_y + block_edge}, linear.col(1), scale, y[e]);
        const int of_z = node + first * plane + second * block_edge;
        subtract_nodes(sum, {of_z, of_z + 1}, linear.col(2), scale, z[e]);
      }
    for (int i = 0; i < 3; ++i) {
      std::array<RowVector, 4> normal;  // Y × Z of index i along x; [2 b' + c']
      for (int b = 0; b < 2; ++b)
        for (int c = 0; c < 2; ++c) {
          if (i == 1)
            half_sum_of_crosses(y[c], z[2 + b], y[2 + c], z[b], normal[2 * b + c]);
          else
            cross(y[i + c], z[i + b], normal[2 * b + c]);
        }
      std::array<std::array<Row, 4>, 4> product;  // [X's 2 b + c][normal's 2 b' + c']
      for (int p = 0; p < 4; ++p)
        for (int q = 0; q < 4; ++q) dot(x[p], normal[q], product[p][q]);
      Row* out = &values[9 * i];
      for (int n = 0; n < lanes; ++n) {
        const auto at = [&](int p, int q) { return product[p][q][n]; };
        out[0][n] = at(0, 0);
        out[1][n] = 0.5 * (at(0, 1) + at(1, 0));
        out[2][n] = at(1, 1);
        out[3][n] = 0.5 * (at(0, 2) + at(2, 0));
        out[4][n] = 0.25 * (at(0, 3) + at(1, 2) + at(2, 1) + at(3, 0));
        out[5][n] = 0.5 * (at(1, 3) + at(3, 1));
        out[6][n] = at(2, 2);
        out[7][n] = 0.5 * (at(2, 3) + at(3, 2));
        out[8][n] = at(3, 3);
      }
    }
  }
};

constexpr int node_of_row(int i, int j) { return number_in_block({i, j, 0}); }

// Bound of the error of a computed coefficient: six products of three components, each at most `largest` and
// off by `component_error`; fewer than 16 roundings on the way of each product to the coefficient.
double rounding_margin(double largest, double component_error) {
  const double grown = largest + component_error;
  return 6 * 3 * grown * grown * component_error + 6 * 32 * unit_roundoff * grown * grown * grown;
}

double largest_component(const NodeBlock& sum, const Matrix3& linear, double scale) {
  double largest = 0;
  for (int c = 0; c < 3; ++c)
    for (int node = 0; node < block_nodes; ++node) largest = std::max(largest, std::abs(sum[c][node]));
  return linear.cwiseAbs().maxCoeff() + 2 * std::abs(scale) * largest;
}

struct BoundRows {
  [[gnu::always_inline]] static void run(const NodeBlock& sum, const Matrix3& linear, double scale,
                                         JacobianBlock& block) {
    RowCoefficients row;
    for (int i = 0; i < leaf_edge; ++i)
      for (int j = 0; j < leaf_edge; ++j) {
        row.compute(sum, node_of_row(i, j), linear, scale);
        double* bound = &block.lower_bound[static_cast<std::size_t>(number_of_place({i, j, 0}))];
        for (int n = 0; n < lanes; ++n) bound[n] = row.values[0][n];
        for (int coefficient = 1; coefficient < 27; ++coefficient)
          for (int n = 0; n < lanes; ++n) {
            const double value = row.values[coefficient][n];
            // Written so that NaN stays: a cell that is not a number is not certified.
            bound[n] = value >= bound[n] ? bound[n] : value;
          }
        for (int n = 0; n < lanes; ++n) bound[n] -= block.margin;
      }
  }
};

}  // namespace

void bound_block(const NodeBlock& sum, const Matrix3& linear, double scale, double scaled_error,
                 JacobianBlock& block) {
  const double largest = largest_component(sum, linear, scale);
  block.margin = rounding_margin(largest, 2 * scaled_error + 8 * unit_roundoff * largest);
  run_dispatched<BoundRows>(sum, linear, scale, block);
}

BezierDeterminant bezier_coefficients(const NodeBlock& sum, int cell, const Matrix3& linear, double scale) {
  const LatticeCoordinates place = place_of_number(cell);
  RowCoefficients row;
  row.compute(sum, node_of_row(place[0], place[1]), linear, scale);
  BezierDeterminant coefficients;
  for (int n = 0; n < 27; ++n) coefficients[n] = row.values[n][static_cast<std::size_t>(place[2])];
  return coefficients;
}

namespace {

// De Casteljau at 1/2 along an axis of the given stride: the lower and the upper part.
std::array<BezierDeterminant, 2> halves(const BezierDeterminant& whole, int stride) {
  std::array<BezierDeterminant, 2> parts;
  for (int n = 0; n < 27; ++n) {
    if (n / stride % 3 != 0) continue;
    const double a = whole[n], b = whole[n + stride], c = whole[n + 2 * stride];
    const double ab = 0.5 * (a + b), bc = 0.5 * (b + c), abc = 0.5 * (ab + bc);
    parts[0][n] = a;
    parts[0][n + stride] = ab;
    parts[0][n + 2 * stride] = abc;
    parts[1][n] = abc;
    parts[1][n + stride] = bc;
    parts[1][n + 2 * stride] = c;
  }
  return parts;
}

double min_corner(const BezierDeterminant& coefficients) {
  double least = std::numeric_limits<double>::infinity();
  for (const int corner : {0, 2, 6, 8, 18, 20, 24, 26}) least = std::min(least, coefficients[corner]);
  return least;
}

constexpr int deepest_subdivision = 26;
constexpr std::size_t largest_number_of_parts = 20000;

}  // namespace

DeterminantRange decide_cell(const BezierDeterminant& coefficients, double margin) {
  struct Part {
    BezierDeterminant coefficients;
    int depth;
  };
  DeterminantRange range;
  range.lower_bound = std::numeric_limits<double>::infinity();
  range.value = std::numeric_limits<double>::infinity();
  bool open = false;
  std::vector<Part> parts = {{coefficients, 0}};
  double largest = 0;
  for (const double coefficient : coefficients) {
    if (!std::isfinite(coefficient)) return {};
    largest = std::max(largest, std::abs(coefficient));
  }
  for (std::size_t done = 0; !parts.empty(); ++done) {
    const Part part = parts.back();
    parts.pop_back();
    // A value within the margin of zero is no proof of a fold; one below it is.
    const double value = min_corner(part.coefficients);
    range.value = std::min(range.value, value);
    // Each halving along three axes rounds six times.
    const double rounding = margin + 8 * part.depth * unit_roundoff * largest;
    if (value <= -rounding) {
      range.verdict = CellVerdict::folded;
      range.value = value;
      return range;
    }
    const double least = *std::min_element(part.coefficients.begin(), part.coefficients.end());
    if (least > rounding) {
      range.lower_bound = std::min(range.lower_bound, least - rounding);
      continue;
    }
    if (part.depth == deepest_subdivision || done == largest_number_of_parts || value <= rounding) {
      open = true;
      // What is left elsewhere may still prove a fold.
      if (done >= largest_number_of_parts) break;
      continue;
    }
    for (const BezierDeterminant& x : halves(part.coefficients, 9))
      for (const BezierDeterminant& y : halves(x, 3))
        for (const BezierDeterminant& z : halves(y, 1)) parts.push_back({z, part.depth + 1});
  }
  if (!open) {
    range.verdict = CellVerdict::certified;
    return range;
  }
  // Zero to within rounding: not positive, as far as the arithmetic can tell.
  range.verdict = range.value <= 0 ? CellVerdict::folded : CellVerdict::undecided;
  return range;
}

}  // namespace bespoke
