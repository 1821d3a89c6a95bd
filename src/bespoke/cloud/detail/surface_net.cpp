#include "bespoke/cloud/detail/surface_net.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <optional>
#include <utility>
#include <vector>

#include "bespoke/parallel.h"

namespace bespoke {
namespace {

constexpr int no_vertex = -1;
constexpr std::size_t vertex_grain = 256;

/// Its active voxels are the nodes of known values.
openvdb::FloatGrid::Ptr known_nodes(const SparseField& field) {
  openvdb::FloatGrid::Ptr grid = openvdb::FloatGrid::create(/*background=*/1);
  openvdb::FloatGrid::Accessor nodes = grid->getAccessor();
  for (std::size_t leaf = 0; leaf < field.leaves.size(); ++leaf)
    for (int number = 0; number < leaf_nodes; ++number) {
      const float value = field.values[leaf * leaf_nodes + static_cast<std::size_t>(number)];
      if (std::isnan(value)) continue;
      const LatticeCoordinates node = moved(first_node(field.leaves[leaf]), place_of_number(number));
      nodes.setValue({node[0], node[1], node[2]}, value);
    }
  return grid;
}

/// The cells of which all eight nodes are known, by their least ones.
openvdb::BoolGrid::Ptr known_cells(const openvdb::FloatGrid& grid) {
  openvdb::BoolGrid::Ptr mask = openvdb::BoolGrid::create(false);
  openvdb::BoolGrid::Accessor cells = mask->getAccessor();
  const openvdb::FloatGrid::ConstAccessor nodes = grid.getConstAccessor();
  for (auto node = grid.cbeginValueOn(); node; ++node) {
    const openvdb::Coord cell = node.getCoord();
    bool is_known = true;
    for (int corner = 1; corner < 8 && is_known; ++corner)
      is_known = nodes.isValueOn(cell.offsetBy(corner & 1, corner >> 1 & 1, corner >> 2));
    if (is_known) cells.setValue(cell, true);
  }
  return mask;
}

/// Polygons between vertices that have a place, as triangles; without the other vertices.
class PlacedNet {
 public:
  explicit PlacedNet(std::vector<std::optional<Vector3>> places)
      : places_(std::move(places)), number_(places_.size(), no_vertex) {}

  /// Corners counter-clockwise, seen from where the values are positive.
  void add(std::initializer_list<openvdb::Index32> polygon) {
    const std::vector<openvdb::Index32> corners(polygon);
    for (const openvdb::Index32 corner : corners)
      if (!places_[corner]) return;
    if (corners.size() == 3) return add_triangle(corners[0], corners[1], corners[2]);
    const auto squared_length = [&](std::size_t from, std::size_t to) {
      return (*places_[corners[from]] - *places_[corners[to]]).squaredNorm();
    };
    const std::size_t first = squared_length(0, 2) <= squared_length(1, 3) ? 0 : 1;
    const auto corner = [&](std::size_t k) { return corners[(first + k) % 4]; };
    add_triangle(corner(0), corner(1), corner(2));
    add_triangle(corner(0), corner(2), corner(3));
  }

  TriangleMesh mesh() const {
    TriangleMesh result;
    result.vertices.resize(3, static_cast<Eigen::Index>(used_.size()));
    for (std::size_t i = 0; i < used_.size(); ++i)
      result.vertices.col(static_cast<Eigen::Index>(i)) = *places_[used_[i]];
    result.faces = Eigen::Map<const Faces>(faces_.data(), 3, static_cast<Eigen::Index>(faces_.size() / 3));
    return result;
  }

 private:
  void add_triangle(openvdb::Index32 a, openvdb::Index32 b, openvdb::Index32 c) {
    for (const openvdb::Index32 corner : {a, b, c}) {
      int& number = number_[corner];
      if (number == no_vertex) {
        number = static_cast<int>(used_.size());
        used_.push_back(corner);
      }
      faces_.push_back(number);
    }
  }

  std::vector<std::optional<Vector3>> places_;
  std::vector<int> number_, faces_;
  std::vector<openvdb::Index32> used_;
};

}  // namespace

TriangleMesh surface_net(const SparseField& field, const PlaceVertex& place) {
  const openvdb::FloatGrid::Ptr grid = known_nodes(field);
  openvdb::tools::VolumeToMesh mesher(/*isovalue=*/0);
  const openvdb::BoolGrid::Ptr cells = known_cells(*grid);
  mesher.setSurfaceMask(cells);
  mesher(*grid);
  std::vector<std::optional<Vector3>> places(mesher.pointListSize());
  parallel_for(places.size(), vertex_grain, [&](std::size_t begin, std::size_t end) {
    const openvdb::BoolGrid::ConstAccessor is_known = cells->getConstAccessor();
    for (std::size_t i = begin; i < end; ++i) {
      const openvdb::Vec3s& start = mesher.pointList()[i];  // in cells
      // The mesher goes on into the cells beside the mask.
      if (!is_known.isValueOn(openvdb::Coord::floor(start))) continue;
      places[i] = place(field.origin + field.cell * Vector3(start[0], start[1], start[2]));
    }
  });
  PlacedNet net(std::move(places));
  for (std::size_t i = 0; i < mesher.polygonPoolListSize(); ++i) {
    const openvdb::tools::PolygonPool& pool = mesher.polygonPoolList()[i];
    for (std::size_t k = 0; k < pool.numQuads(); ++k) {
      const openvdb::Vec4I& quad = pool.quad(k);
      net.add({quad[0], quad[1], quad[2], quad[3]});
    }
    for (std::size_t k = 0; k < pool.numTriangles(); ++k) {
      const openvdb::Vec3I& triangle = pool.triangle(k);
      net.add({triangle[0], triangle[1], triangle[2]});
    }
  }
  return net.mesh();
}

}  // namespace bespoke
