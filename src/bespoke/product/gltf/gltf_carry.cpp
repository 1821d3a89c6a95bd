#include <algorithm>
#include <string>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/output_stream.h"
#include "bespoke/product/carry/product_formats.h"
#include "bespoke/product/gltf/scene/gltf_carrier.h"
#include "bespoke/product/gltf/scene/gltf_frame.h"
#include "bespoke/product/gltf/scene/gltf_rig_write.h"

namespace bespoke {
namespace {

namespace fs = std::filesystem;

/// The file that a buffer beside `output` is written to.
fs::path buffer_path(const fs::path& output, std::size_t buffer, std::size_t buffers) {
  std::string name = output.stem().string();
  if (buffers > 1) name.append("_").append(std::to_string(buffer));
  return output.parent_path() / name.append(".bin");
}

/// A stream has no neighbours.
void require_place_for_buffers(const GltfFile& file, const std::vector<OutputFile>& outputs) {
  for (const OutputFile& output : outputs)
    if (is_stream(output.name()))
      throw InvalidInput(file.path.string() + ": has buffers in files of their own, which cannot go into " +
                         output.name().string() + "; pack it into a .glb, or name a file");
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
    frame.buffers()[buffer].write(*companions++);
  }
  write_gltf(file, frame.text(), frame.buffers().empty() ? GltfBuffer() : frame.buffers().front(), output);
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

/// One a frame; without nodes where nothing is skinned.
std::vector<GltfCarriedRig> rigs_of(const GltfFile& file, const std::vector<GltfAccessor>& accessors,
                                    const GltfPlan& plan, const PointMotion& motion) {
  if (plan.scene.poses.empty()) return std::vector<GltfCarriedRig>(motion.frames);
  return carry_rig(file, accessors, plan, motion);
}

/// Meshes that hang on a joint without being skinned go with it, and what joints held in another pose than it
/// is stored in is stored as it is shown: a shift of the whole, undone by the blend of each vertex, would
/// fold it.
std::vector<GltfCarriedPlaces> carried_places(const GltfPlan& plan, const std::vector<GltfCarriedRig>& rigs) {
  std::vector<GltfCarriedPlaces> result;
  for (const GltfCarriedRig& rig : rigs) {
    GltfCarriedPlaces& places = result.emplace_back(plan.places.size());
    for (std::size_t i = 0; rig.is_changed && i < places.size(); ++i) {
      if (!plan.places[i].of_vertices.empty()) places[i] = AffineMap();
      const auto holder = plan.places[i].holder;
      if (holder && !is_same(rig.nodes[*holder].scene_from_node, plan.places[i].scene_from_mesh))
        places[i] = rig.nodes[*holder].scene_from_node;
    }
  }
  return result;
}

/// Of one frame: what becomes of every task of the plan, and the skeleton.
struct CarriedFrame {
  std::vector<GltfCarried> values;
  GltfCarriedRig rig;

  bool is_changed() const {
    return rig.is_changed ||
           std::any_of(values.begin(), values.end(), [](const GltfCarried& own) { return own.is_changed; });
  }
};

GltfFrame filled(const GltfFile& file, const std::vector<GltfAccessor>& accessors, const GltfPlan& plan,
                 CarriedFrame& carried) {
  // Where nothing moves, nothing needs copies either.
  const bool is_changed = carried.is_changed();
  GltfFrame frame(file, accessors, is_changed ? plan.json : file.json);
  for (std::size_t k = 0; is_changed && k < plan.tasks.size(); ++k)
    if (carried.values[k].is_changed || plan.tasks[k].is_copy())
      frame.store(plan.tasks[k], std::move(carried.values[k].values));
  if (carried.rig.is_changed) write_rig(file, accessors, plan.scene, carried.rig, frame);
  return frame;
}

/// What is carried, a frame each, and how much that is.
std::vector<CarriedFrame> carry_frames(const GltfFile& file, const std::vector<GltfAccessor>& accessors,
                                       const GltfPlan& plan, const PointMotion& motion,
                                       const Progress& progress) {
  std::vector<GltfCarriedRig> rigs = rigs_of(file, accessors, plan, motion);
  const GltfCarrier carrier(file, accessors, plan, motion, carried_places(plan, rigs));
  std::vector<CarriedFrame> frames(motion.frames);
  for (const GltfTask& task : plan.tasks) {
    progress.check();
    std::vector<GltfCarried> values = carrier.carry(task);
    for (std::size_t i = 0; i < frames.size(); ++i) frames[i].values.push_back(std::move(values[i]));
  }
  for (std::size_t i = 0; i < frames.size(); ++i) frames[i].rig = std::move(rigs[i]);
  return frames;
}

void count(const std::vector<GltfAccessor>& accessors, const GltfPlan& plan, CarrySummary& summary) {
  for (const GltfTask& task : plan.tasks)
    (task.role == GltfRole::position ? summary.points : summary.directions) += accessors[task.source()].count;
  const std::vector<bool>& rigged = plan.scene.is_rigged;
  summary.joints = static_cast<std::size_t>(std::count(rigged.begin(), rigged.end(), true));
}

CarrySummary carry_in_pose(ModelPose pose, const InputFile& input, std::vector<OutputFile>& outputs,
                           const PointMotion& motion, const Progress& progress) {
  const GltfFile file = read_gltf(input);
  const std::vector<GltfAccessor> accessors = read_accessors(file);
  const GltfPlan plan = plan_gltf(file, accessors, pose);
  if (plan.tasks.empty()) throw FormatError(input.path().string() + ": the file shows no vertices");
  CarrySummary summary;
  summary.warnings = plan.warnings;
  for (std::string& warning : rig_warnings(file)) summary.warnings.push_back(std::move(warning));
  warn_of_textures(file, outputs.front().name(), summary);
  std::vector<CarriedFrame> carried = carry_frames(file, accessors, plan, motion, progress);
  count(accessors, plan, summary);

  motion.accept();  // buffers beside the file are written first
  const std::vector<std::size_t> beside = buffers_beside(file);
  if (!beside.empty()) require_place_for_buffers(file, outputs);
  for (const OutputFile& output : outputs)
    for (const std::size_t buffer : beside)
      summary.companions.push_back(buffer_path(output.name(), buffer, file.buffers.size()));
  require_no_input(file, summary.companions);
  write_outputs(summary.companions, [&](std::vector<OutputFile>& companions) {
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      progress.check();
      GltfFrame frame = filled(file, accessors, plan, carried[i]);
      write_frame(file, frame, outputs[i], companions.data() + i * beside.size());
    }
  });
  return summary;
}

}  // namespace

CarrySummary carry_gltf(const InputFile& input, std::vector<OutputFile>& outputs, const PointMotion& motion,
                        const Progress& progress) {
  return carry_in_pose(ModelPose::shown, input, outputs, motion, progress);
}

CarrySummary carry_stored_gltf(const InputFile& input, std::vector<OutputFile>& outputs,
                               const PointMotion& motion, const Progress& progress) {
  return carry_in_pose(ModelPose::stored, input, outputs, motion, progress);
}

}  // namespace bespoke
