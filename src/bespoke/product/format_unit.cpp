#include "bespoke/product/format_unit.h"

#include <array>

#include "bespoke/digits.h"
#include "bespoke/error.h"
#include "bespoke/named.h"
#include "bespoke/words.h"

namespace bespoke {
namespace {

constexpr std::array units{
    Named<double>{"m", 1},           Named<double>{"metre", 1},   Named<double>{"meter", 1},
    Named<double>{"metres", 1},      Named<double>{"meters", 1},  Named<double>{"dm", 0.1},
    Named<double>{"cm", 0.01},       Named<double>{"mm", 0.001},  Named<double>{"um", 1e-6},
    Named<double>{"km", 1000},       Named<double>{"in", 0.0254}, Named<double>{"inch", 0.0254},
    Named<double>{"inches", 0.0254}, Named<double>{"ft", 0.3048}};

}  // namespace

std::optional<double> metres_per_unit(const std::string& unit) { return value_of(units, lower_case(unit)); }

std::string unit_of_format(const std::filesystem::path& path) {
  const std::string ending = lower_ending(path);
  return ending == ".gltf" || ending == ".glb" ? "m" : "";
}

void require_unit_of_format(const std::filesystem::path& model, const std::string& unit) {
  if (unit.empty() || unit_of_format(model).empty()) return;
  const std::optional<double> metres = metres_per_unit(unit);
  if (metres == 1) return;
  std::string message = model.string() + ": is in metres, as every glTF file, but the anchors are in " + unit;
  if (metres)
    message += "; multiply their coordinates by " + in_digits(*metres, 4) + " and say \"units\": \"m\"";
  throw InvalidInput(message);
}

}  // namespace bespoke
