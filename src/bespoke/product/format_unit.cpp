#include "bespoke/product/format_unit.h"

#include <array>

#include "bespoke/enum_names.h"
#include "bespoke/error.h"
#include "bespoke/number_format.h"
#include "bespoke/product/detail/threemf_model.h"
#include "bespoke/strings.h"

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
  if (ending == ".3mf") return unit_of_3mf(InputFile(path));
  return ending == ".gltf" || ending == ".glb" ? "m" : "";
}

void require_unit_of_format(const std::filesystem::path& model, const std::string& unit) {
  if (unit.empty()) return;
  const std::string own = unit_of_format(model);
  if (own.empty()) return;
  const std::optional<double> metres = metres_per_unit(unit);
  const double own_metres = *metres_per_unit(own);
  if (metres == own_metres) return;
  std::string message = model.string() + (own == "m" ? ": is in metres" : ": is in " + own) +
                        (lower_ending(model) == ".3mf" ? ", as its file says" : ", as every glTF file") +
                        ", but the anchors are in " + unit;
  if (metres)
    message += "; multiply their coordinates by " + format_number(*metres / own_metres, 4) +
               " and say \"units\": \"" + own + "\"";
  throw InvalidInput(message);
}

}  // namespace bespoke
