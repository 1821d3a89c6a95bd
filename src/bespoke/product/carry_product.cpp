#include "bespoke/product/carry_product.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "bespoke/error.h"
#include "bespoke/product/detail/product_formats.h"

namespace bespoke {
namespace {

namespace fs = std::filesystem;

struct Format {
  std::string_view ending;
  CarrySummary (*carry)(const InputFile&, std::vector<OutputFile>&, const PointMotion&, const Progress&);
};

constexpr std::array formats{Format{".obj", carry_obj},   Format{".ply", carry_ply},
                             Format{".stl", carry_stl},   Format{".off", carry_off},
                             Format{".gltf", carry_gltf}, Format{".glb", carry_gltf},
                             Format{".xyz", carry_xyz},   Format{".csv", carry_csv}};

const Format* find_format(const fs::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto at = std::find_if(formats.begin(), formats.end(),
                               [&](const Format& format) { return format.ending == ending; });
  return at == formats.end() ? nullptr : at;
}

}  // namespace

bool has_product_ending(const fs::path& path) { return find_format(path) != nullptr; }

std::string product_endings() {
  std::string text;
  for (const Format& format : formats) {
    if (!text.empty()) text += &format == &formats.back() ? " or " : ", ";
    text += format.ending;
  }
  return text;
}

CarrySummary carry_product(const fs::path& input, const std::vector<fs::path>& outputs,
                           const PointMotion& motion, const Progress& progress) {
  if (outputs.size() != motion.frames)
    throw InvalidInput(std::to_string(outputs.size()) + " outputs for a motion of " +
                       std::to_string(motion.frames) + " frames; the numbers must be equal");
  const Format* const format = find_format(input);
  if (!format) throw InvalidInput(input.string() + ": the name must end in " + product_endings());
  for (const fs::path& output : outputs)
    if (find_format(output) != format)
      throw InvalidInput(output.string() + ": must have the ending of " + input.string());
  const InputFile file(input);
  CarrySummary summary;
  write_outputs(
      outputs, [&](std::vector<OutputFile>& open) { summary = format->carry(file, open, motion, progress); });
  return summary;
}

}  // namespace bespoke
