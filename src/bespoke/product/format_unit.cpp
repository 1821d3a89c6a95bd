#include "bespoke/product/format_unit.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <sstream>

#include "bespoke/error.h"

namespace bespoke {
namespace {

struct Unit {
  std::string_view name;
  double metres;
};

constexpr std::array units{
    Unit{"m", 1},       Unit{"metre", 1},     Unit{"meter", 1},       Unit{"metres", 1}, Unit{"meters", 1},
    Unit{"dm", 0.1},    Unit{"cm", 0.01},     Unit{"mm", 0.001},      Unit{"um", 1e-6},  Unit{"km", 1000},
    Unit{"in", 0.0254}, Unit{"inch", 0.0254}, Unit{"inches", 0.0254}, Unit{"ft", 0.3048}};

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

}  // namespace

std::string unit_of_format(const std::filesystem::path& path) {
  const std::string ending = lower(path.extension().string());
  return ending == ".gltf" || ending == ".glb" ? "m" : "";
}

void require_unit_of_format(const std::filesystem::path& model, const std::string& unit) {
  if (unit.empty() || unit_of_format(model).empty()) return;
  const auto known = std::find_if(units.begin(), units.end(), [&, name = lower(unit)](const Unit& candidate) {
    return candidate.name == name;
  });
  if (known != units.end() && known->metres == 1) return;
  std::ostringstream message;
  message << model.string() << ": is in metres, as every glTF file, but the anchors are in " << unit;
  if (known != units.end())
    message << "; multiply their coordinates by " << known->metres << " and say \"units\": \"m\"";
  throw InvalidInput(message.str());
}

}  // namespace bespoke
