#include "bespoke/product/gltf/scene/gltf_carrier.h"

#include <atomic>
#include <optional>
#include <string>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/parallel.h"
#include "bespoke/product/carry/directions.h"

namespace bespoke {
namespace {

constexpr std::size_t points_at_a_time = std::size_t{1} << 14;

std::optional<std::size_t> first_not_finite(const Eigen::Ref<const GltfValues>& values) {
  if (values.allFinite()) return std::nullopt;
  Eigen::Index i = 0;
  while (values.col(i).allFinite()) ++i;
  return static_cast<std::size_t>(i);
}

/// Directions that have changed, of which whole numbers have rounded the length: rounding them once more
/// would take them further from one.
void make_unit(const GltfValues& before, Eigen::Ref<GltfValues> now) {
  for (Eigen::Index i = 0; i < now.cols(); ++i)
    if (now.col(i) != before.col(i)) now.col(i).head<3>().normalize();
}

/// L⁻¹ of every vertex's displacement.
Points undone(const GltfPlacement& place, const Points& displacements, std::size_t first) {
  if (place.of_vertices.empty()) return place.scene_from_mesh.linear.inverse() * displacements;
  Points result(3, displacements.cols());
  for (Eigen::Index i = 0; i < result.cols(); ++i)
    result.col(i) = place.at(first + static_cast<std::size_t>(i)).linear.inverse() * displacements.col(i);
  return result;
}

}  // namespace

std::vector<GltfCarried> GltfCarrier::carry(const GltfTask& task) const {
  const GltfAccessor& source = accessors_[task.source()];
  std::vector<GltfCarried> result(motion_.frames);
  for (GltfCarried& frame : result)
    frame.values.resize(static_cast<Eigen::Index>(source.components),
                        static_cast<Eigen::Index>(source.count));
  std::vector<std::atomic<bool>> is_changed(motion_.frames);
  const bool is_rounded =
      task.role != GltfRole::position && !task.difference && source.component != GltfComponent::real;
  parallel_for(source.count, points_at_a_time, [&](std::size_t begin, std::size_t end) {
    const GltfValues before = read_values(source, file_.buffers, begin, end - begin);
    const std::vector<Points> moved = carry_block(task, before, begin);
    for (std::size_t frame = 0; frame < motion_.frames; ++frame) {
      auto block = result[frame].values.middleCols(static_cast<Eigen::Index>(begin), before.cols());
      block = before;
      block.topRows<3>() = moved[frame].cast<float>();
      if (is_rounded) make_unit(before, block);
      if (const auto vector = first_not_finite(block))
        throw InvalidInput(file_.path.string() + ": " + source.pointer + ": vector " +
                           std::to_string(begin + *vector) +
                           " goes to a place that is not finite in single precision");
      if (block != before) is_changed[frame] = true;
    }
  });
  for (std::size_t frame = 0; frame < motion_.frames; ++frame) result[frame].is_changed = is_changed[frame];
  return result;
}

std::vector<Points> GltfCarrier::carry_block(const GltfTask& task, const GltfValues& before,
                                             std::size_t first) const {
  const auto read = [&](std::size_t accessor) -> Points {
    const auto count = static_cast<std::size_t>(before.cols());
    const GltfValues values = read_values(accessors_[accessor], file_.buffers, first, count);
    if (const auto vector = first_not_finite(values))
      throw FormatError(file_.path.string() + ": " + accessors_[accessor].pointer + ": vector " +
                        std::to_string(first + *vector) + " is not finite");
    return values.topRows<3>().cast<double>();
  };
  const Points x = read(task.positions);
  const Points base = task.base == task.positions ? x : read(task.base);
  const std::vector<LocalMotion> at_base = local_motion(x, task, first);
  std::vector<Points> moved;
  for (const LocalMotion& motion : at_base) moved.push_back(carried(task.role, base, motion));
  if (!task.difference) return moved;

  const Points difference = read(*task.difference);
  const std::vector<LocalMotion> at_morph =
      task.difference_of_positions ? local_motion(x + read(*task.difference_of_positions), task, first)
                                   : at_base;
  // Only what the motion changes is added, so that a difference that stays keeps its bits.
  for (std::size_t frame = 0; frame < motion_.frames; ++frame) {
    const Points morphed = base + difference;
    moved[frame] =
        difference + ((carried(task.role, morphed, at_morph[frame]) - morphed) - (moved[frame] - base));
  }
  return moved;
}

/// With y = L x + b the scene's point and Ψ the scene's motion, x + L⁻¹ (Ψ(y) − y), which is x itself where
/// nothing moves, and L⁻¹ ∇Ψ L. With another map L' for what is carried, L'⁻¹ Ψ(y) and L'⁻¹ ∇Ψ L.
std::vector<GltfCarrier::LocalMotion> GltfCarrier::local_motion(const Points& x, const GltfTask& task,
                                                                std::size_t first) const {
  const GltfPlacement& place = plan_.places[task.place];
  const auto linear_at = [&](Eigen::Index i) -> const Matrix3& {
    return place.at(first + static_cast<std::size_t>(i)).linear;
  };
  const Points y = in_scene(place, x, first);
  const bool with_jacobians = task.role != GltfRole::position;
  std::vector<Points> images, jacobians;
  if (with_jacobians)
    jacobians = motion_.jacobians(y);
  else
    images = task.difference ? motion_.at_other_points(y) : motion_.images(y);
  std::vector<LocalMotion> result(motion_.frames);
  for (std::size_t frame = 0; frame < motion_.frames; ++frame) {
    const auto other = places_.empty() ? std::nullopt : places_[frame][task.place];
    if (!with_jacobians) {
      result[frame].images = other ? Points(inverse_of(*other) * images[frame])
                                   : Points(x + undone(place, images[frame] - y, first));
      continue;
    }
    Points& local = result[frame].jacobians = std::move(jacobians[frame]);
    for (Eigen::Index i = 0; i < x.cols(); ++i)
      if (auto jacobian = local.middleCols<3>(3 * i); other || jacobian != Matrix3::Identity())
        jacobian = ((other ? other->linear : linear_at(i)).inverse() * jacobian * linear_at(i)).eval();
  }
  return result;
}

Points GltfCarrier::carried(GltfRole role, const Points& values, const LocalMotion& motion) {
  if (role == GltfRole::position) return motion.images;
  return role == GltfRole::normal ? moved_normals(values, motion.jacobians)
                                  : moved_tangents(values, motion.jacobians);
}

}  // namespace bespoke
