#include "bespoke/bake/band.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

struct Ball {
  Vector3 center;  // in the support's frame
  double radius;
};

// As many leaves as this across are finer than a float resolves, and their cubes still fit 64 bits.
constexpr int largest_leaf = 1 << 20;

Matrix3 inverse_frame(const Support& support) {
  const Matrix3& linear = support.frame.linear;
  if (!(linear.allFinite() && support.frame.offset.allFinite()))
    throw InvalidInput("the frame of the map's support is not finite");
  const Matrix3 inverse = linear.inverse();
  // Beyond this the support is a needle along which no lattice makes sense.
  constexpr double largest_condition = 1e9;
  if (!(inverse.norm() * linear.norm() < largest_condition))
    throw InvalidInput("the frame of the map's support is singular (determinant " +
                       std::to_string(linear.determinant()) + "): the affine part flattens space");
  return inverse;
}

std::vector<Ball> balls_of(const Support& support) {
  std::vector<Ball> balls;
  for (const BallCloud& cloud : support.clouds) {
    if (!(cloud.radius >= 0 && std::isfinite(cloud.radius) && cloud.centers.allFinite()))
      throw InvalidInput("a ball of the map's support is not finite");
    for (Eigen::Index i = 0; i < cloud.centers.cols(); ++i)
      balls.push_back({cloud.centers.col(i), cloud.radius});
  }
  // Large balls first: they settle most boxes with one test.
  std::stable_sort(balls.begin(), balls.end(),
                   [](const Ball& a, const Ball& b) { return a.radius > b.radius; });
  return balls;
}

// Descends an octree of boxes of leaves, keeping for each box the balls that its nodes may touch.
class BandSearch {
 public:
  BandSearch(const Support& support, const Lattice& lattice) : frame_(support.frame), lattice_(lattice) {
    const std::vector<Ball> balls = balls_of(support);
    require_lattice(support, lattice);
    if (balls.empty()) return;
    const Box box = bounding_box(support);
    const double leaf_size = leaf_edge * lattice.voxel_size;
    const Vector3 low = (box.min() - lattice.origin) / leaf_size;
    const Vector3 high = (box.max() - lattice.origin) / leaf_size;
    while ((high - low).maxCoeff() > (1 << depth_)) ++depth_;
    // One node of slack: a node of the leaf below may touch the box by rounding.
    const auto root = [&](double leaf) { return static_cast<int>(std::floor(leaf)) >> depth_; };
    for (int i = root(low.x() - 0.5); i <= root(high.x() + 0.5); ++i)
      for (int j = root(low.y() - 0.5); j <= root(high.y() + 0.5); ++j)
        for (int k = root(low.z() - 0.5); k <= root(high.z() + 0.5); ++k) add_root({i, j, k}, balls, depth_);
    // Enough of them for all threads; every ball is queried once a level by the few boxes near it.
    constexpr std::size_t enough_roots = 256;
    for (; depth_ > 0 && roots_.size() < enough_roots; --depth_) {
      const std::vector<Root> parents = std::exchange(roots_, {});
      for (const Root& parent : parents)
        for (int octant = 0; octant < 8; ++octant)
          add_root(child_of(parent.at, octant), parent.touching, depth_ - 1);
    }
  }

  std::size_t roots() const { return roots_.size(); }

  // emit(corner, depth): all 8^depth leaves from `corner` · 2^depth on.
  template <class Emit>
  void search(std::size_t root, const Emit& emit) const {
    descend(roots_[root].at, depth_, roots_[root].touching, emit);
  }

 private:
  struct Root {
    LeafCoordinates at;
    std::vector<Ball> touching;
  };

  void add_root(const LeafCoordinates& at, const std::vector<Ball>& candidates, int depth) {
    std::vector<Ball> touching = touching_balls(at, depth, candidates).balls;
    if (!touching.empty()) roots_.push_back({at, std::move(touching)});
  }

  struct Touching {
    std::vector<Ball> balls;
    bool one_holds_all = false;  // and is then the only one listed
  };

  Touching touching_balls(const LeafCoordinates& at, int depth, const std::vector<Ball>& candidates) const {
    const double half_edge = 0.5 * ((leaf_edge << depth) - 1) * lattice_.voxel_size;
    const double corner = static_cast<double>(leaf_edge << depth) * lattice_.voxel_size;
    const Vector3 middle =
        frame_ * Vector3(lattice_.origin + corner * as_vector(at) + Vector3::Constant(half_edge));
    double reach = 0;  // of the box's image around its middle
    for (int sign = 0; sign < 4; ++sign)
      reach = std::max(reach, (frame_.linear * Vector3(half_edge, sign & 1 ? half_edge : -half_edge,
                                                       sign & 2 ? half_edge : -half_edge))
                                  .norm());
    reach *= 1 + 1e-12;  // rounding must not lose a leaf that touches
    Touching touching;
    for (const Ball& ball : candidates) {
      const double distance = (middle - ball.center).norm();
      if (distance + reach <= ball.radius) return {{ball}, true};
      if (distance - reach <= ball.radius * (1 + 1e-12)) touching.balls.push_back(ball);
    }
    return touching;
  }

  template <class Emit>
  void descend(const LeafCoordinates& at, int depth, const std::vector<Ball>& candidates,
               const Emit& emit) const {
    const Touching touching = touching_balls(at, depth, candidates);
    if (touching.balls.empty()) return;
    if (depth == 0 || touching.one_holds_all) return emit(at, depth);
    for (int octant = 0; octant < 8; ++octant) descend(child_of(at, octant), depth - 1, touching.balls, emit);
  }

  AffineMap frame_;
  Lattice lattice_;
  int depth_ = 0;
  std::vector<Root> roots_;  // of edge 2^depth_ leaves
};

}  // namespace

void require_lattice(const Support& support, const Lattice& lattice) {
  char text[120];
  if (!(lattice.voxel_size > 0 && std::isfinite(lattice.voxel_size) && lattice.origin.allFinite())) {
    std::snprintf(text, sizeof text, "voxel size %.4g is not positive and finite", lattice.voxel_size);
    throw InvalidInput(text);
  }
  const Box box = bounding_box(support);
  if (box.isEmpty()) return;
  const double leaf_size = leaf_edge * lattice.voxel_size;
  const Vector3 low = (box.min() - lattice.origin) / leaf_size;
  const Vector3 high = (box.max() - lattice.origin) / leaf_size;
  if (low.minCoeff() > -largest_leaf && high.maxCoeff() < largest_leaf) return;
  std::snprintf(text, sizeof text, "voxel size %.4g is too fine for a band of %.4g mesh units",
                lattice.voxel_size, box.sizes().maxCoeff());
  throw InvalidInput(text);
}

std::vector<LeafCoordinates> band_leaves(const Support& support, const Lattice& lattice) {
  const BandSearch search(support, lattice);
  std::vector<std::vector<LeafCoordinates>> found(search.roots());
  parallel_for(found.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t root = begin; root < end; ++root)
      search.search(root, [&](const LeafCoordinates& at, int depth) {
        const int edge = 1 << depth;
        for (int i = 0; i < edge; ++i)
          for (int j = 0; j < edge; ++j)
            for (int k = 0; k < edge; ++k)
              found[root].push_back({edge * at[0] + i, edge * at[1] + j, edge * at[2] + k});
      });
  });
  std::vector<LeafCoordinates> leaves;
  for (const auto& part : found) leaves.insert(leaves.end(), part.begin(), part.end());
  std::sort(leaves.begin(), leaves.end());
  return leaves;
}

std::size_t count_band_leaves(const Support& support, const Lattice& lattice) {
  const BandSearch search(support, lattice);
  return parallel_reduce(
      search.roots(), 1, std::size_t{0},
      [&](std::size_t begin, std::size_t end) {
        std::size_t count = 0;
        for (std::size_t root = begin; root < end; ++root)
          search.search(root,
                        [&](const LeafCoordinates&, int depth) { count += std::size_t{1} << (3 * depth); });
        return count;
      },
      [](std::size_t a, std::size_t b) { return a + b; });
}

Box bounding_box(const Support& support) {
  Box box;
  const Matrix3 inverse = inverse_frame(support);
  for (const BallCloud& cloud : support.clouds)
    for (Eigen::Index i = 0; i < cloud.centers.cols(); ++i) {
      const Vector3 center = inverse * (cloud.centers.col(i) - support.frame.offset);
      const Vector3 reach = cloud.radius * inverse.rowwise().norm();
      box.extend(Vector3(center - reach));
      box.extend(Vector3(center + reach));
    }
  return box;
}

}  // namespace bespoke
