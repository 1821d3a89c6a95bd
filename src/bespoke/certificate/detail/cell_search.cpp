#include "bespoke/certificate/detail/cell_search.h"

#include <Eigen/LU>
#include <array>
#include <utility>

namespace bespoke {
namespace {

using Corners = std::array<Vector3, 8>;  // corner (a, b, c) at 4 a + 2 b + c

Vector3 trilinear(const Corners& p, const Vector3& f) {
  const auto along_z = [&](int pair) {
    return Vector3(p[2 * pair] + f.z() * (p[2 * pair + 1] - p[2 * pair]));
  };
  const Vector3 low = along_z(0) + f.y() * (along_z(1) - along_z(0));
  const Vector3 high = along_z(2) + f.y() * (along_z(3) - along_z(2));
  return low + f.x() * (high - low);
}

Matrix3 trilinear_gradient(const Corners& p, const Vector3& f) {
  Matrix3 gradient;
  for (int axis = 0; axis < 3; ++axis) {
    Vector3 low = f, high = f;
    low[axis] = 0;
    high[axis] = 1;
    gradient.col(axis) = trilinear(p, high) - trilinear(p, low);
  }
  return gradient;
}

// A part of a cell's unit cube.
struct Part {
  Vector3 low;
  double edge;
  int depth;
};

Box image_of(const Corners& corners, const Part& part) {
  Box box;
  for (int n = 0; n < 8; ++n)
    box.extend(trilinear(corners, part.low + part.edge * as_vector(corner_step(n))));
  return box;
}

// The image of a part of a trilinear cell lies in the hull of its corners' images, so a part whose box misses
// y cannot hold the root. Newton from the middle of a part ends the search as soon as it stays in the cell.
std::optional<Vector3> solve(const Corners& corners, const Vector3& y, double tolerance) {
  constexpr int deepest = 40;
  constexpr int newton_steps = 8;
  // A root on a face may come out beyond it by rounding.
  constexpr double slack = 1e-9;
  std::vector<Part> parts = {{Vector3::Zero(), 1.0, 0}};
  while (!parts.empty()) {
    const Part part = parts.back();
    parts.pop_back();
    Box box = image_of(corners, part);
    box.min().array() -= tolerance;
    box.max().array() += tolerance;
    if (!box.contains(y)) continue;
    Vector3 f = part.low + Vector3::Constant(part.edge / 2);
    for (int step = 0; step < newton_steps; ++step) {
      const Vector3 missing = y - trilinear(corners, f);
      if (missing.norm() <= tolerance && (f.array() >= -slack).all() && (f.array() <= 1 + slack).all())
        return f;
      f += Matrix3(trilinear_gradient(corners, f)).inverse() * missing;
      if (!(f.cwiseAbs().maxCoeff() < 8)) break;
    }
    if (part.depth == deepest) continue;
    for (int n = 0; n < 8; ++n)
      parts.push_back({part.low + part.edge / 2 * as_vector(corner_step(n)), part.edge / 2, part.depth + 1});
  }
  return std::nullopt;
}

Vector3 node_place(const Pyramid& pyramid, int level, const LeafCoordinates& leaf, int number) {
  return pyramid.lattice(level)(moved(first_node(leaf), place_in_block(number)));
}

}  // namespace

CellSearch::CellSearch(const BakedMap& map) : map_(map) {
  const PyramidIndex index(map.pyramid());
  if (index.levels.empty()) return;
  for (std::size_t root = 0; root < index.levels.front().size(); ++root)
    visit_finest_cells(index, root, [&](const EntryCells& cells) {
      Entry entry{cells.level, cells.leaf, cells.finest, {}};
      for (int node = 0; node < block_nodes; ++node) {
        const Vector3 x = node_place(map.pyramid(), cells.level, cells.leaf, node);
        entry.image.extend(map.affine() * x +
                           Vector3((*cells.sum)[0][node], (*cells.sum)[1][node], (*cells.sum)[2][node]));
      }
      entries_.push_back(std::move(entry));
    });
}

std::optional<Vector3> CellSearch::find(const Vector3& y, double tolerance) const {
  for (const Entry& entry : entries_) {
    if (!(entry.image.squaredExteriorDistance(y) <= tolerance * tolerance)) continue;
    if (const std::optional<Vector3> found = find_in(entry, y, tolerance)) return found;
  }
  return std::nullopt;
}

std::optional<Vector3> CellSearch::find_in(const Entry& entry, const Vector3& y, double tolerance) const {
  Points nodes(3, block_nodes);
  for (int node = 0; node < block_nodes; ++node)
    nodes.col(node) = node_place(map_.pyramid(), entry.level, entry.leaf, node);
  const Points images = map_(nodes);
  const double voxel_size = map_.pyramid().lattice(entry.level).voxel_size;
  for (int cell = 0; cell < leaf_nodes; ++cell) {
    if (!entry.finest[static_cast<std::size_t>(cell)]) continue;
    const LatticeCoordinates place = place_of_number(cell);
    const int lower = number_in_block(place);
    Corners corners;
    for (int n = 0; n < 8; ++n)
      corners[static_cast<std::size_t>(n)] = images.col(number_in_block(moved(place, corner_step(n))));
    const std::optional<Vector3> fraction = solve(corners, y, tolerance / 2);
    if (fraction) return Vector3(nodes.col(lower) + voxel_size * *fraction);
  }
  return std::nullopt;
}

}  // namespace bespoke
