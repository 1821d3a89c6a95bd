#include "lookup_rivals.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>
#ifdef BESPOKE_HAS_NANOVDB
#include <nanovdb/util/OpenToNanoVDB.h>
#include <nanovdb/util/SampleFromVoxels.h>
#endif

#include <array>
#include <cmath>
#include <vector>

#include "bespoke/lattice/baked_map.h"

namespace bespoke {
namespace {

class DenseArray : public LookUpRival {
 public:
  DenseArray(const Pyramid& pyramid, const Box& box) : low_(box.min()) {
    constexpr double largest_bytes = 64e6;
    for (const PyramidLevel& level : pyramid.levels) {
      const Eigen::Array3d nodes = (box.sizes() / level.voxel_size).array().ceil() + 1;
      if (sizeof(float) * 3 * nodes.prod() > largest_bytes) break;
      voxel_size_ = level.voxel_size;
      for (int axis = 0; axis < 3; ++axis) size_[axis] = static_cast<int>(nodes[axis]);
    }
    Points x(3, static_cast<Eigen::Index>(size_[0]) * size_[1] * size_[2]);
    Eigen::Index column = 0;
    for (int i = 0; i < size_[0]; ++i)
      for (int j = 0; j < size_[1]; ++j)
        for (int k = 0; k < size_[2]; ++k) x.col(column++) = low_ + voxel_size_ * Vector3(i, j, k);
    const Points u = BakedMap({}, pyramid).displacement(x);
    values_.assign(u.data(), u.data() + u.size());
  }

  void look_up(const double* x, std::size_t count, double* u) const override {
    for (std::size_t i = 0; i < count; ++i, x += 3, u += 3) {
      std::array<int, 3> cell;
      std::array<double, 3> f;
      for (int axis = 0; axis < 3; ++axis) {
        const double at = (x[axis] - low_[axis]) / voxel_size_;
        cell[axis] = std::min(std::max(static_cast<int>(at), 0), size_[axis] - 2);
        f[axis] = at - cell[axis];
      }
      blend(&values_[3 * ((static_cast<std::size_t>(cell[0]) * static_cast<std::size_t>(size_[1]) +
                           static_cast<std::size_t>(cell[1])) *
                              static_cast<std::size_t>(size_[2]) +
                          static_cast<std::size_t>(cell[2]))],
            f, u);
    }
  }

 private:
  void blend(const float* corner, const std::array<double, 3>& f, double* u) const {
    const std::ptrdiff_t y = 3 * size_[2], x = y * size_[1];
    for (int c = 0; c < 3; ++c) {
      const auto along_z = [&](const float* node) { return node[c] + f[2] * (node[c + 3] - node[c]); };
      const double low = along_z(corner) + f[1] * (along_z(corner + y) - along_z(corner));
      const double high = along_z(corner + x) + f[1] * (along_z(corner + x + y) - along_z(corner + x));
      u[c] = low + f[0] * (high - low);
    }
  }

  Vector3 low_;
  double voxel_size_ = 0;
  std::array<int, 3> size_{};
  std::vector<float> values_;
};

std::vector<openvdb::Vec3SGrid::Ptr> grids_of(const Pyramid& pyramid) {
  openvdb::initialize();
  std::vector<openvdb::Vec3SGrid::Ptr> grids;
  for (const PyramidLevel& level : pyramid.levels) {
    const auto grid = openvdb::Vec3SGrid::create(openvdb::Vec3s(0));
    const auto transform = openvdb::math::Transform::createLinearTransform(level.voxel_size);
    transform->postTranslate({pyramid.origin.x(), pyramid.origin.y(), pyramid.origin.z()});
    grid->setTransform(transform);
    for (std::size_t leaf = 0; leaf < level.leaves.size(); ++leaf) {
      auto* const to = grid->tree().touchLeaf(openvdb::Coord(first_node(level.leaves[leaf]).data()));
      const float* from = level.values_of(leaf);
      for (openvdb::Index node = 0; node < leaf_nodes; ++node)
        to->setValueOn(node, {from[3 * node], from[3 * node + 1], from[3 * node + 2]});
    }
    grids.push_back(grid);
  }
  return grids;
}

class BoxSampler : public LookUpRival {
 public:
  explicit BoxSampler(const Pyramid& pyramid) : grids_(grids_of(pyramid)) {}

  void look_up(const double* x, std::size_t count, double* u) const override {
    using Accessor = openvdb::Vec3SGrid::ConstAccessor;
    std::vector<Accessor> accessors;
    for (const auto& grid : grids_) accessors.push_back(grid->getConstAccessor());
    std::vector<openvdb::tools::GridSampler<Accessor, openvdb::tools::BoxSampler>> samplers;
    for (std::size_t level = 0; level < grids_.size(); ++level)
      samplers.emplace_back(accessors[level], grids_[level]->transform());
    for (std::size_t i = 0; i < count; ++i, x += 3, u += 3) {
      openvdb::Vec3d sum(0.0);
      for (const auto& sampler : samplers) sum += sampler.wsSample({x[0], x[1], x[2]});
      for (int c = 0; c < 3; ++c) u[c] = sum[c];
    }
  }

 private:
  std::vector<openvdb::Vec3SGrid::Ptr> grids_;
};

#ifdef BESPOKE_HAS_NANOVDB
class CachedSampler : public LookUpRival {
 public:
  explicit CachedSampler(const Pyramid& pyramid) : origin_(pyramid.origin) {
    for (const auto& grid : grids_of(pyramid)) handles_.push_back(nanovdb::openToNanoVDB(grid));
    for (const PyramidLevel& level : pyramid.levels) scales_.push_back(1 / level.voxel_size);
  }

  void look_up(const double* x, std::size_t count, double* u) const override {
    using Accessor = nanovdb::Vec3fGrid::AccessorType;
    std::vector<Accessor> accessors;
    for (const auto& handle : handles_) accessors.push_back(handle.grid<nanovdb::Vec3f>()->getAccessor());
    std::vector<nanovdb::SampleFromVoxels<Accessor, 1, true>> samplers;
    for (const Accessor& accessor : accessors) samplers.emplace_back(accessor);
    for (std::size_t i = 0; i < count; ++i, x += 3, u += 3) {
      nanovdb::Vec3d sum(0.0);
      for (std::size_t level = 0; level < samplers.size(); ++level) {
        const Vector3 at = scales_[level] * (Eigen::Map<const Vector3>(x) - origin_);
        const nanovdb::Vec3f value = samplers[level](nanovdb::Vec3d(at.x(), at.y(), at.z()));
        for (int c = 0; c < 3; ++c) sum[c] += value[c];
      }
      for (int c = 0; c < 3; ++c) u[c] = sum[c];
    }
  }

 private:
  Vector3 origin_;
  std::vector<double> scales_;
  std::vector<nanovdb::GridHandle<>> handles_;
};
#endif

}  // namespace

std::shared_ptr<const LookUpRival> dense_array(const Pyramid& pyramid, const Box& box) {
  return std::make_shared<DenseArray>(pyramid, box);
}

std::shared_ptr<const LookUpRival> openvdb_box_sampler(const Pyramid& pyramid) {
  return std::make_shared<BoxSampler>(pyramid);
}

std::shared_ptr<const LookUpRival> nanovdb_cached_sampler([[maybe_unused]] const Pyramid& pyramid) {
#ifdef BESPOKE_HAS_NANOVDB
  return std::make_shared<CachedSampler>(pyramid);
#else
  return nullptr;
#endif
}

}  // namespace bespoke
