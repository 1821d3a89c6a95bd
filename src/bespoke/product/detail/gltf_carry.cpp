#include <atomic>
#include <optional>
#include <string>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/parallel.h"
#include "bespoke/product/detail/directions.h"
#include "bespoke/product/detail/gltf_frame.h"
#include "bespoke/product/detail/product_formats.h"

namespace bespoke {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t points_at_a_time = std::size_t{1} << 14;

/// Values of an accessor in one frame.
struct Carried {
  GltfValues values;
  bool is_changed = false;
};

/// How points of a mesh move in one frame, in the mesh's coordinates.
struct LocalMotion {
  Points images, jacobians;
};

class GltfCarrier {
 public:
  GltfCarrier(const GltfFile& file, const std::vector<GltfAccessor>& accessors, const GltfPlan& plan,
              const PointMotion& motion)
      : file_(file), accessors_(accessors), plan_(plan), motion_(motion) {}

  /// One result a frame.
  std::vector<Carried> carry(const GltfTask& task) const {
    const GltfAccessor& source = accessors_[task.source()];
    std::vector<Carried> result(motion_.frames);
    for (Carried& frame : result)
      frame.values.resize(static_cast<Eigen::Index>(source.components),
                          static_cast<Eigen::Index>(source.count));
    std::vector<std::atomic<bool>> is_changed(motion_.frames);
    parallel_for(source.count, points_at_a_time, [&](std::size_t begin, std::size_t end) {
      const GltfValues before = read_values(source, file_.buffers, begin, end - begin);
      const std::vector<Points> moved = carry_block(task, before, begin);
      for (std::size_t frame = 0; frame < motion_.frames; ++frame) {
        auto block = result[frame].values.middleCols(static_cast<Eigen::Index>(begin), before.cols());
        block = before;
        block.topRows<3>() = moved[frame].cast<float>();
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

 private:
  /// What vectors `before`, from number `first` on, of the task's accessor become in every frame.
  std::vector<Points> carry_block(const GltfTask& task, const GltfValues& before, std::size_t first) const {
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
    const std::vector<LocalMotion> at_base = local_motion(x, task);
    std::vector<Points> moved;
    for (const LocalMotion& motion : at_base) moved.push_back(carried(task.role, base, motion));
    if (!task.difference) return moved;

    const Points difference = read(*task.difference);
    const std::vector<LocalMotion> at_morph =
        task.difference_of_positions ? local_motion(x + read(*task.difference_of_positions), task) : at_base;
    // Only what the motion changes is added, so that a difference that stays keeps its bits.
    for (std::size_t frame = 0; frame < motion_.frames; ++frame) {
      const Points morphed = base + difference;
      moved[frame] =
          difference + ((carried(task.role, morphed, at_morph[frame]) - morphed) - (moved[frame] - base));
    }
    return moved;
  }

  /// With y = L x + b the scene's point and Ψ the scene's motion, x + L⁻¹ (Ψ(y) − y), which is x itself where
  /// nothing moves, and L⁻¹ ∇Ψ L.
  std::vector<LocalMotion> local_motion(const Points& x, const GltfTask& task) const {
    const AffineMap& scene_from_mesh = plan_.places[task.place];
    const Matrix3 back = scene_from_mesh.linear.inverse();
    const Points y = in_scene(scene_from_mesh, x);
    const bool with_jacobians = task.role != GltfRole::position;
    std::vector<Points> images, jacobians;
    if (with_jacobians)
      jacobians = motion_.jacobians(y);
    else
      images = task.difference ? motion_.at_other_points(y) : motion_.images(y);
    std::vector<LocalMotion> result(motion_.frames);
    for (std::size_t frame = 0; frame < motion_.frames; ++frame) {
      if (!with_jacobians) {
        result[frame].images = x + back * (images[frame] - y);
        continue;
      }
      Points& local = result[frame].jacobians = std::move(jacobians[frame]);
      for (Eigen::Index i = 0; i < local.cols(); i += 3)
        if (local.middleCols<3>(i) != Matrix3::Identity())
          local.middleCols<3>(i) = (back * local.middleCols<3>(i) * scene_from_mesh.linear).eval();
    }
    return result;
  }

  static Points carried(GltfRole role, const Points& values, const LocalMotion& motion) {
    if (role == GltfRole::position) return motion.images;
    return role == GltfRole::normal ? moved_normals(values, motion.jacobians)
                                    : moved_tangents(values, motion.jacobians);
  }

  static std::optional<std::size_t> first_not_finite(const Eigen::Ref<const GltfValues>& values) {
    if (values.allFinite()) return std::nullopt;
    Eigen::Index i = 0;
    while (values.col(i).allFinite()) ++i;
    return static_cast<std::size_t>(i);
  }

  const GltfFile& file_;
  const std::vector<GltfAccessor>& accessors_;
  const GltfPlan& plan_;
  const PointMotion& motion_;
};

/// The file that a buffer beside `output` is written to.
fs::path buffer_path(const fs::path& output, std::size_t buffer, std::size_t buffers) {
  std::string name = output.stem().string();
  if (buffers > 1) name.append("_").append(std::to_string(buffer));
  return output.parent_path() / name.append(".bin");
}

/// Which buffers are files beside the .gltf.
std::vector<std::size_t> buffers_beside(const GltfFile& file) {
  std::vector<std::size_t> result;
  const std::vector<GltfPart> buffers = file.root().elements("buffers");
  for (std::size_t i = 0; i < buffers.size(); ++i)
    if (buffers[i].has("uri") && !is_data_uri(buffers[i].text("uri"))) result.push_back(i);
  return result;
}

void require_no_input(const GltfFile& file, const std::vector<fs::path>& companions) {
  for (const std::size_t buffer : buffers_beside(file)) {
    const fs::path input =
        file.path.parent_path() / file_name_of_uri(file.json["buffers"][buffer]["uri"].get<std::string>());
    for (const fs::path& companion : companions) {
      std::error_code none;
      if (fs::equivalent(input, companion, none))
        throw InvalidInput(companion.string() + ": is a buffer of " + file.path.string() +
                           " and would be overwritten; choose another name or directory");
    }
  }
}

void write_frame(const GltfFile& file, GltfFrame& frame, OutputFile& output, OutputFile* companions) {
  for (const std::size_t buffer : buffers_beside(file)) {
    frame.name_buffer(buffer, buffer_path(output.name(), buffer, frame.buffers().size()).filename());
    (companions++)->write(frame.buffers()[buffer]);
  }
  write_gltf(file, frame.text(), frame.buffers().empty() ? "" : frame.buffers().front(), output);
}

/// Textures keep their names, which are relative to the file.
void warn_of_textures(const GltfFile& file, const fs::path& output, CarrySummary& summary) {
  std::error_code none;
  if (fs::equivalent(fs::absolute(file.path).parent_path(), fs::absolute(output).parent_path(), none)) return;
  for (const GltfPart& image : file.root().elements("images"))
    if (image.has("uri") && !image.text("uri").starts_with("data:")) {
      summary.warnings.push_back("textures are files beside it, which were not copied: " + image.text("uri") +
                                 " for instance");
      return;
    }
}

}  // namespace

CarrySummary carry_gltf(const InputFile& input, std::vector<OutputFile>& outputs, const PointMotion& motion,
                        const Progress& progress) {
  GltfFile file = read_gltf(input);
  const std::vector<GltfAccessor> accessors = read_accessors(file);
  const GltfPlan plan = plan_gltf(file, accessors);
  if (plan.tasks.empty()) throw FormatError(input.path().string() + ": the file shows no vertices");
  CarrySummary summary;
  summary.warnings = plan.warnings;
  warn_of_textures(file, outputs.front().name(), summary);
  const GltfCarrier carrier(file, accessors, plan, motion);
  std::vector<std::vector<Carried>> carried;
  for (const GltfTask& task : plan.tasks) {
    progress.check();
    carried.push_back(carrier.carry(task));
    (task.role == GltfRole::position ? summary.points : summary.directions) += accessors[task.source()].count;
  }

  const std::vector<std::size_t> beside = buffers_beside(file);
  for (const OutputFile& output : outputs)
    for (const std::size_t buffer : beside)
      summary.companions.push_back(buffer_path(output.name(), buffer, file.buffers.size()));
  require_no_input(file, summary.companions);
  write_outputs(summary.companions, [&](std::vector<OutputFile>& companions) {
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      progress.check();
      bool is_changed = false;
      for (const std::vector<Carried>& frames : carried) is_changed = is_changed || frames[i].is_changed;
      // Where nothing moves, nothing needs copies either.
      GltfFrame frame(file, accessors, is_changed ? plan.json : file.json,
                      i + 1 < outputs.size() ? file.buffers : std::move(file.buffers));
      for (std::size_t k = 0; is_changed && k < plan.tasks.size(); ++k)
        if (carried[k][i].is_changed || plan.tasks[k].is_copy())
          frame.store(plan.tasks[k], carried[k][i].values);
      write_frame(file, frame, outputs[i], companions.data() + i * beside.size());
    }
  });
  return summary;
}

}  // namespace bespoke
