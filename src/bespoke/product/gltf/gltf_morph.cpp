#include "bespoke/product/morph_product.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <optional>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/product/gltf/document/gltf_additions.h"
#include "bespoke/product/gltf/scene/gltf_carrier.h"
#include "bespoke/unknown_ending.h"

namespace bespoke {
namespace {

constexpr const char* roles[] = {"POSITION", "NORMAL", "TANGENT"};

/// What is appended to a file: values behind its buffer, and their accessors.
class Additions {
 public:
  Additions(GltfJson& json, std::vector<GltfBuffer>& buffers) : json_(json), buffers_(buffers) {}

  /// Vectors of three, or numbers, with their bounds where these are requested.
  std::size_t add(const GltfValues& values, bool has_bounds, bool is_of_vertices) {
    GltfPlace wanted;
    wanted.components = static_cast<std::size_t>(values.rows());
    wanted.count = static_cast<std::size_t>(values.cols());
    const GltfPlace place = add_view(json_, buffers_, wanted,
                                     is_of_vertices ? std::optional(GltfTarget::vertices) : std::nullopt);
    buffers_.front().replace(rows_of_values(place, values));
    GltfJson accessor = {{"bufferView", json_["bufferViews"].size() - 1},
                         {"componentType", static_cast<int>(GltfComponent::real)},
                         {"count", values.cols()},
                         {"type", values.rows() == 3 ? "VEC3" : "SCALAR"}};
    for (Eigen::Index axis = 0; has_bounds && axis < values.rows(); ++axis) {
      accessor["min"].push_back(values.row(axis).minCoeff());
      accessor["max"].push_back(values.row(axis).maxCoeff());
    }
    json_["accessors"].push_back(std::move(accessor));
    return json_["accessors"].size() - 1;
  }
  std::size_t add(const std::vector<float>& numbers, bool has_bounds) {
    return add(
        Eigen::Map<const Eigen::RowVectorXf>(numbers.data(), static_cast<Eigen::Index>(numbers.size())),
        has_bounds, false);
  }

 private:
  GltfJson& json_;
  std::vector<GltfBuffer>& buffers_;
};

class Morpher {
 public:
  Morpher(GltfFile& file, const PointMotion& motion)
      : file_(file), accessors_(read_accessors(file)), plan_(plan_gltf(file, accessors_)), motion_(motion) {
    if (plan_.tasks.empty()) throw FormatError(file.path.string() + ": the file shows no vertices");
    for (std::size_t k = 0; k < plan_.tasks.size(); ++k) {
      if (plan_.tasks[k].difference)
        throw InvalidInput(file.path.string() +
                           ": has morph targets of its own, beside which others would need a blend of both; "
                           "`bespoke apply` carries it");
      task_of_result_[plan_.tasks[k].result] = k;
    }
    // Meshes that are shown twice have the same values at t = 0.
    json_ = plan_.json;
    GltfJson& all = json_["accessors"];
    all.erase(all.begin() + static_cast<std::ptrdiff_t>(accessors_.size()), all.end());
  }

  MorphSummary run(double seconds, const Progress& progress) {
    MorphSummary summary;
    summary.warnings = plan_.warnings;
    if (!plan_.scene.poses.empty())
      summary.warnings.emplace_back(
          "its skeleton stays where it is at t = 0, since morph targets move no joints; `bespoke apply` "
          "carries it");
    Additions additions(json_, file_.buffers);
    for (const GltfTask& task : plan_.tasks) {
      progress.check();
      targets_.push_back(add_targets(task, additions, summary));
    }
    const MorphTrack track = morph_track(motion_.frames / 2, seconds);
    std::vector<bool> morphs;
    for (GltfJson& mesh : json_["meshes"]) morphs.push_back(give_targets(mesh, track));
    add_animation(morphs, track, additions);
    return summary;
  }

  std::string text() const { return edited_json(file_.text, file_.json, json_); }

 private:
  /// The accessors of the differences of every target.
  std::vector<std::size_t> add_targets(const GltfTask& task, Additions& additions, MorphSummary& summary) {
    const GltfAccessor& source = accessors_[task.base];
    const GltfValues before = read_values(source, file_.buffers, 0, source.count).topRows(3);
    const std::vector<GltfCarried> frames = GltfCarrier(file_, accessors_, plan_, motion_).carry(task);
    const auto at = [&](std::size_t frame) -> GltfValues {
      return frame == 0 ? before : GltfValues(frames[frame - 1].values.topRows(3));
    };
    std::vector<std::size_t> result;
    for (std::size_t frame = 2; frame <= motion_.frames; frame += 2) {
      result.push_back(additions.add(at(frame) - before, task.role == GltfRole::position, true));
      if (task.role != GltfRole::position) continue;
      const GltfValues off = at(frame - 1) - 0.5f * (at(frame - 2) + at(frame));
      const GltfPlacement& place = plan_.places[task.place];
      for (Eigen::Index i = 0; i < off.cols(); ++i)
        summary.off_path =
            std::max(summary.off_path,
                     (place.at(static_cast<std::size_t>(i)).linear * off.col(i).cast<double>()).norm());
    }
    if (task.role == GltfRole::position) summary.points += source.count;
    return result;
  }

  /// Whether the mesh got targets: of the attributes that are carried.
  bool give_targets(GltfJson& mesh, const MorphTrack& track) {
    bool has_any = false;
    for (GltfJson& primitive : mesh["primitives"]) {
      if (!primitive.contains("attributes")) continue;
      for (const char* role : roles) {
        if (!primitive["attributes"].contains(role)) continue;
        GltfJson& slot = primitive["attributes"][role];
        const auto task = task_of_result_.find(slot.get<std::size_t>());
        if (task == task_of_result_.end()) continue;
        if (plan_.tasks[task->second].is_copy()) slot = plan_.tasks[task->second].base;
        for (std::size_t k = 0; k < track.names.size(); ++k)
          primitive["targets"][k][role] = targets_[task->second][k];
        has_any = true;
      }
    }
    if (!has_any) return false;
    mesh["weights"] = std::vector<int>(track.names.size());
    mesh["extras"]["targetNames"] = track.names;
    return true;
  }

  /// Of the weights of all nodes that show a mesh with targets.
  void add_animation(const std::vector<bool>& morphs, const MorphTrack& track, Additions& additions) {
    GltfJson animation = {{"name", "t from 0 to 1"}};
    animation["samplers"].push_back({{"input", additions.add(track.times, true)},
                                     {"output", additions.add(track.weights, false)},
                                     {"interpolation", "LINEAR"}});
    for (std::size_t node = 0; node < json_["nodes"].size(); ++node) {
      const GltfJson& own = json_["nodes"][node];
      if (own.contains("mesh") && morphs[own["mesh"].get<std::size_t>()])
        animation["channels"].push_back({{"sampler", 0}, {"target", {{"node", node}, {"path", "weights"}}}});
    }
    json_["animations"].push_back(std::move(animation));
  }

  GltfFile& file_;
  const std::vector<GltfAccessor> accessors_;
  const GltfPlan plan_;
  const PointMotion& motion_;
  std::map<std::size_t, std::size_t> task_of_result_;  ///< by accessor
  std::vector<std::vector<std::size_t>> targets_;      ///< of every task, of every target
  GltfJson json_;
};

}  // namespace

MorphTrack morph_track(std::size_t targets, double seconds) {
  MorphTrack track;
  track.weights.resize((targets + 1) * targets);
  for (std::size_t k = 0; k <= targets; ++k) {
    const double t = static_cast<double>(k) / static_cast<double>(targets);
    track.times.push_back(static_cast<float>(seconds * t));
    if (k == 0) continue;
    track.weights[k * targets + k - 1] = 1;
    char name[32];
    std::snprintf(name, sizeof name, "t = %.4g", t);
    track.names.emplace_back(name);
  }
  return track;
}

MorphSummary morph_product(const std::filesystem::path& input, const std::filesystem::path& output,
                           const PointMotion& motion, double seconds, const Progress& progress) {
  for (const std::filesystem::path& path : {input, output})
    if (path.extension() != ".glb") throw UnknownEnding(path.string() + ": the name must end in .glb");
  if (motion.frames == 0 || motion.frames % 2 != 0)
    throw InvalidInput("a motion of " + std::to_string(motion.frames) +
                       " frames; morphing needs two a target, the first half way");
  const InputFile glb(input);
  GltfFile file = read_gltf(glb);
  if (!file.has_binary_chunk() || file.buffers.size() != 1)
    throw InvalidInput(input.string() + ": has buffers that are not in the file; pack them into the .glb");
  Morpher morpher(file, motion);
  MorphSummary summary = morpher.run(seconds, progress);
  write_outputs({output}, [&](std::vector<OutputFile>& outputs) {
    write_gltf(file, morpher.text(), file.buffers.front(), outputs.front());
  });
  return summary;
}

}  // namespace bespoke
