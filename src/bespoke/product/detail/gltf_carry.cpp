#include <string>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/output_stream.h"
#include "bespoke/product/detail/gltf_carrier.h"
#include "bespoke/product/detail/gltf_frame.h"
#include "bespoke/product/detail/product_formats.h"

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

}  // namespace

CarrySummary carry_gltf(const InputFile& input, std::vector<OutputFile>& outputs, const PointMotion& motion,
                        const Progress& progress) {
  const GltfFile file = read_gltf(input);
  const std::vector<GltfAccessor> accessors = read_accessors(file);
  const GltfPlan plan = plan_gltf(file, accessors);
  if (plan.tasks.empty()) throw FormatError(input.path().string() + ": the file shows no vertices");
  CarrySummary summary;
  summary.warnings = plan.warnings;
  warn_of_textures(file, outputs.front().name(), summary);
  const GltfCarrier carrier(file, accessors, plan, motion);
  std::vector<std::vector<GltfCarried>> carried;
  for (const GltfTask& task : plan.tasks) {
    progress.check();
    carried.push_back(carrier.carry(task));
    (task.role == GltfRole::position ? summary.points : summary.directions) += accessors[task.source()].count;
  }

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
      bool is_changed = false;
      for (const std::vector<GltfCarried>& frames : carried) is_changed = is_changed || frames[i].is_changed;
      // Where nothing moves, nothing needs copies either.
      GltfFrame frame(file, accessors, is_changed ? plan.json : file.json);
      for (std::size_t k = 0; is_changed && k < plan.tasks.size(); ++k)
        if (carried[k][i].is_changed || plan.tasks[k].is_copy())
          frame.store(plan.tasks[k], std::move(carried[k][i].values));
      write_frame(file, frame, outputs[i], companions.data() + i * beside.size());
    }
  });
  return summary;
}

}  // namespace bespoke
