#include "bespoke/product/carry_product.h"

#include <algorithm>
#include <array>
#include <memory>
#include <string_view>

#include "bespoke/atomic_file.h"
#include "bespoke/error.h"
#include "bespoke/output_stream.h"
#include "bespoke/product/carry/product_formats.h"
#include "bespoke/product/gltf/scene/gltf_bind.h"
#include "bespoke/product/product_io.h"
#include "bespoke/strings.h"
#include "bespoke/unknown_ending.h"

namespace bespoke {
namespace {

namespace fs = std::filesystem;

struct Format {
  std::string_view ending;
  CarrySummary (*carry)(const InputFile&, std::vector<OutputFile>&, const PointMotion&, const Progress&);
  std::vector<PartPoints> (*find_parts)(const InputFile&, const std::vector<RigidPart>&,
                                        const Progress&) = nullptr;  ///< where the format knows parts
  /// Writes the file with edges split, where that is known.
  void (*split)(const InputFile&, const FaceSplits&, OutputFile&) = nullptr;
};

constexpr Format shown_gltf(std::string_view ending) {
  return {ending, carry_gltf, find_gltf_parts, split_gltf};
}

constexpr std::array formats{Format{".obj", carry_obj, find_obj_parts, split_obj},
                             Format{".ply", carry_ply, find_ply_parts, split_ply},
                             Format{".stl", carry_stl, nullptr, split_stl},
                             Format{".off", carry_off, nullptr, split_off},
                             shown_gltf(".gltf"),
                             shown_gltf(".glb"),
                             Format{".xyz", carry_xyz},
                             Format{".csv", carry_csv}};

const Format* find_format(const fs::path& path) {
  const auto at =
      std::find_if(formats.begin(), formats.end(),
                   [ending = lower_ending(path)](const Format& format) { return format.ending == ending; });
  return at == formats.end() ? nullptr : at;
}

bool has_gltf_ending(const fs::path& path) {
  const std::string ending = lower_ending(path);
  return ending == ".glb" || ending == ".gltf";
}

Format known_format(const fs::path& path, ModelPose pose) {
  if (has_gltf_ending(path) && pose == ModelPose::stored)
    return {"glTF", carry_stored_gltf, find_stored_gltf_parts, split_stored_gltf};
  if (const Format* const format = find_format(path)) return *format;
  throw UnknownEnding(path.string() + ": the name must end in " + product_endings() +
                      conversion_advice(path));
}

std::vector<PartPoints> find_parts(const Format& format, const InputFile& file,
                                   const std::vector<RigidPart>& parts, const Progress& progress) {
  if (parts.empty()) return {};
  if (!format.find_parts)
    throw InvalidInput(file.path().string() +
                       ": only OBJ, PLY and glTF files have parts that can keep their shape");
  return format.find_parts(file, parts, progress);
}

CarrySummary carry_and_bind(const Format& format, const InputFile& file, std::vector<OutputFile>& outputs,
                            const PointMotion& motion, const CarryOptions& options) {
  if (lower_ending(file.path()) != ".glb" || outputs.size() != 1)
    throw InvalidInput(file.path().string() +
                       ": only one .glb is bound to a skeleton; export the product as .glb, at one time");
  if (!options.skeleton || !has_gltf_ending(*options.skeleton))
    throw UnknownEnding(options.skeleton.value_or("").string() +
                        ": a skeleton is read from a name that ends in .glb or .gltf");
  const InputFile target(*options.skeleton);
  CarrySummary summary;
  const auto carried = InputFile::of_written(directory_of_temporaries(outputs.front().name()), file.path(),
                                             [&](OutputFile& output) {
                                               std::vector<OutputFile> one;
                                               one.push_back(std::move(output));
                                               summary = format.carry(file, one, motion, options.progress);
                                               output = std::move(one.front());
                                             });
  summary.joints = bind_gltf(*carried, target, options.pose, outputs.front());
  return summary;
}

}  // namespace

bool has_product_ending(const fs::path& path) { return find_format(path) != nullptr; }

bool can_split_product(const fs::path& path) {
  const Format* const format = find_format(path);
  return format && format->split;
}

std::string product_endings() {
  std::vector<std::string> known;
  for (const Format& format : formats) known.emplace_back(format.ending);
  return alternatives(known);
}

CarrySummary carry_product(const fs::path& input, const std::vector<fs::path>& outputs,
                           const PointMotion& motion, const CarryOptions& options) {
  if (outputs.size() != motion.frames)
    throw InvalidInput(std::to_string(outputs.size()) + " outputs for a motion of " +
                       std::to_string(motion.frames) + " frames; the numbers must be equal");
  const Format format = known_format(input, options.pose);
  for (const fs::path& output : outputs)
    if (find_format(output) != find_format(input) && !is_stream(output))
      throw UnknownEnding(output.string() + ": must have the ending of " + input.string());
  auto file = std::make_unique<InputFile>(input);
  const std::vector<PartPoints> parts = find_parts(format, *file, options.parts, options.progress);
  std::vector<PartPoints> places = parts;
  if (options.splits) {
    if (!format.split) throw InvalidInput(input.string() + ": edges of such a file cannot be split");
    file = InputFile::of_written(directory_of_temporaries(outputs.front()), input,
                                 [&](OutputFile& split) { format.split(*file, *options.splits, split); });
    places = find_parts(format, *file, options.parts, options.progress);
  }
  MotionWithParts own{motion, {}};
  if (!parts.empty()) own = with_rigid_parts(motion, parts, places, input);
  CarrySummary summary;
  write_outputs(outputs, [&](std::vector<OutputFile>& open) {
    summary = options.skeleton ? carry_and_bind(format, *file, open, own.motion, options)
                               : format.carry(*file, open, own.motion, options.progress);
    own.motion.accept();
  });
  summary.parts = std::move(own.parts);
  return summary;
}

std::vector<int> parts_of_places(const fs::path& input, const Points& places, const CarryOptions& options) {
  const InputFile file(input);
  const Format format = known_format(input, options.pose);
  return parts_at(places, find_parts(format, file, options.parts, options.progress), input);
}

std::vector<RigidPart> parts_present(const fs::path& input, const std::vector<RigidPart>& parts,
                                     ModelPose pose) {
  const InputFile file(input);
  const Format format = known_format(input, pose);
  std::vector<RigidPart> present;
  if (!format.find_parts) return present;
  for (const RigidPart& part : parts) {
    try {
      format.find_parts(file, {part}, {});
      present.push_back(part);
    } catch (const UnknownPart&) {
    }
  }
  return present;
}

}  // namespace bespoke
