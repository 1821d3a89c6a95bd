#include "bespoke/elastic/detail/face_distances.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "bespoke/instruction_set.h"

namespace bespoke {
namespace {

/// Squared distances of x from the triangles begin … end − 1. Without branches, so that several triangles are
/// evaluated at once: the point of the plane where it is inside, else the nearest point of the three edges.
struct Measure {
  [[gnu::always_inline]] static void run(const FaceDistances::Columns& t, int begin, int end,
                                         const Vector3& x, double* result) {
    const double* const ax = t.corner[0].data();
    const double* const ay = t.corner[1].data();
    const double* const az = t.corner[2].data();
    const double* const bx = t.first[0].data();
    const double* const by = t.first[1].data();
    const double* const bz = t.first[2].data();
    const double* const cx = t.second[0].data();
    const double* const cy = t.second[1].data();
    const double* const cz = t.second[2].data();
    const double* const bb = t.bb.data();
    const double* const bc = t.bc.data();
    const double* const cc = t.cc.data();
    const double* const inverse_det = t.inverse_det.data();
    const double* const inverse_bb = t.inverse_bb.data();
    const double* const inverse_cc = t.inverse_cc.data();
    const double* const inverse_ee = t.inverse_ee.data();
    const double x0 = x[0], x1 = x[1], x2 = x[2];
    const auto squared = [](double u, double v, double w) { return u * u + v * v + w * w; };
    const auto clamped = [](double share) {
      share = share > 0 ? share : 0;
      return share < 1 ? share : 1;
    };
#pragma GCC ivdep
    for (int i = begin; i < end; ++i) {
      const double px = x0 - ax[i], py = x1 - ay[i], pz = x2 - az[i];
      const double pb = px * bx[i] + py * by[i] + pz * bz[i];
      const double pc = px * cx[i] + py * cy[i] + pz * cz[i];
      const double b = (cc[i] * pb - bc[i] * pc) * inverse_det[i];
      const double c = (bb[i] * pc - bc[i] * pb) * inverse_det[i];
      const double inside =
          squared(px - b * bx[i] - c * cx[i], py - b * by[i] - c * cy[i], pz - b * bz[i] - c * cz[i]);
      const double on_b = clamped(pb * inverse_bb[i]);
      const double at_b = squared(px - on_b * bx[i], py - on_b * by[i], pz - on_b * bz[i]);
      const double on_c = clamped(pc * inverse_cc[i]);
      const double at_c = squared(px - on_c * cx[i], py - on_c * cy[i], pz - on_c * cz[i]);
      const double ex = cx[i] - bx[i], ey = cy[i] - by[i], ez = cz[i] - bz[i];
      const double qx = px - bx[i], qy = py - by[i], qz = pz - bz[i];
      const double on_e = clamped((qx * ex + qy * ey + qz * ez) * inverse_ee[i]);
      const double at_e = squared(qx - on_e * ex, qy - on_e * ey, qz - on_e * ez);
      const double at_bc = at_b < at_c ? at_b : at_c;
      const double at_edge = at_bc < at_e ? at_bc : at_e;
      const double least = b < c ? b : c;
      const double rest = 1 - b - c;
      const double smallest_weight = least < rest ? least : rest;
      result[i - begin] = smallest_weight >= 0 ? inside : at_edge;
    }
  }
};

void append(FaceDistances::Columns& columns, const Matrix3& corners) {
  const Vector3 b = corners.col(1) - corners.col(0), c = corners.col(2) - corners.col(0);
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    columns.corner[k].push_back(corners(axis, 0));
    columns.first[k].push_back(b[axis]);
    columns.second[k].push_back(c[axis]);
  }
  const double bb = b.squaredNorm(), bc = b.dot(c), cc = c.squaredNorm();
  columns.bb.push_back(bb);
  columns.bc.push_back(bc);
  columns.cc.push_back(cc);
  columns.inverse_det.push_back(1 / b.cross(c).squaredNorm());
  columns.inverse_bb.push_back(1 / bb);
  columns.inverse_cc.push_back(1 / cc);
  columns.inverse_ee.push_back(1 / (c - b).squaredNorm());
}

}  // namespace

FaceDistances::FaceDistances(const std::vector<Matrix3>& corners, double radius) : radius_(radius) {
  Points centers(3, static_cast<Eigen::Index>(corners.size()));
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector3 center = corners[i].rowwise().mean();
    centers.col(static_cast<Eigen::Index>(i)) = center;
    reach_ = std::max(reach_, radius + (corners[i].colwise() - center).colwise().norm().maxCoeff());
  }
  low_ = centers.rowwise().minCoeff();
  const Vector3 extent = centers.rowwise().maxCoeff() - low_;
  // Half the reach leaves rows long enough for the vector unit; the cap bounds the table.
  constexpr int max_cells_an_axis = 128;
  cell_ = std::max(reach_ / 2, extent.maxCoeff() / max_cells_an_axis);
  for (int axis = 0; axis < 3; ++axis)
    cells_[static_cast<std::size_t>(axis)] = static_cast<int>(extent[axis] / cell_) + 1;

  std::vector<int> cell_of(corners.size());
  cell_start_.assign(static_cast<std::size_t>(cells_[0]) * static_cast<std::size_t>(cells_[1]) *
                             static_cast<std::size_t>(cells_[2]) +
                         1,
                     0);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector3 center = centers.col(static_cast<Eigen::Index>(i));
    cell_of[i] = (cell_along(2, center.z()) * cells_[1] + cell_along(1, center.y())) * cells_[0] +
                 cell_along(0, center.x());
    ++cell_start_[static_cast<std::size_t>(cell_of[i]) + 1];
  }
  std::partial_sum(cell_start_.begin(), cell_start_.end(), cell_start_.begin());
  order_.resize(corners.size());
  std::iota(order_.begin(), order_.end(), 0);
  std::stable_sort(order_.begin(), order_.end(), [&](int i, int j) {
    return cell_of[static_cast<std::size_t>(i)] < cell_of[static_cast<std::size_t>(j)];
  });
  for (const int i : order_) append(columns_, corners[static_cast<std::size_t>(i)]);
}

int FaceDistances::cell_along(int axis, double coordinate) const {
  const double cell = std::floor((coordinate - low_[axis]) / cell_);
  return static_cast<int>(std::clamp(cell, 0.0, cells_[static_cast<std::size_t>(axis)] - 1.0));
}

const std::vector<FaceDistances::Near>& FaceDistances::find(const Vector3& x, Scratch& scratch) const {
  scratch.near.clear();
  if (!x.allFinite()) return scratch.near;
  const double squared_radius = radius_ * radius_;
  const auto distance_to = [&](int axis, int cell) {
    const double low = low_[axis] + cell * cell_;
    return std::max({0.0, low - x[axis], x[axis] - (low + cell_)});
  };
  for (int k = cell_along(2, x.z() - reach_); k <= cell_along(2, x.z() + reach_); ++k)
    for (int j = cell_along(1, x.y() - reach_); j <= cell_along(1, x.y() + reach_); ++j) {
      const double off_z = distance_to(2, k), off_y = distance_to(1, j);
      const double left = reach_ * reach_ - off_z * off_z - off_y * off_y;
      if (left < 0) continue;
      const double half = std::sqrt(left);
      const int row = (k * cells_[1] + j) * cells_[0];
      const int begin = cell_start_[static_cast<std::size_t>(row + cell_along(0, x.x() - half))];
      const int end = cell_start_[static_cast<std::size_t>(row + cell_along(0, x.x() + half)) + 1];
      if (begin == end) continue;
      scratch.distances.resize(std::max(scratch.distances.size(), static_cast<std::size_t>(end - begin)));
      run_dispatched<Measure>(columns_, begin, end, x, scratch.distances.data());
      for (int i = begin; i < end; ++i) {
        const double squared_distance = scratch.distances[static_cast<std::size_t>(i - begin)];
        if (squared_distance < squared_radius) scratch.near.push_back({i, squared_distance});
      }
    }
  return scratch.near;
}

}  // namespace bespoke
