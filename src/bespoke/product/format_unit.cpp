#include "bespoke/product/format_unit.h"

#include <array>
#include <cmath>

#include "bespoke/enum_names.h"
#include "bespoke/error.h"
#include "bespoke/number_format.h"
#include "bespoke/product/threemf/threemf_model.h"
#include "bespoke/strings.h"

namespace bespoke {
namespace {

constexpr std::array units{
    Named<double>{"m", 1},           Named<double>{"metre", 1},   Named<double>{"meter", 1},
    Named<double>{"metres", 1},      Named<double>{"meters", 1},  Named<double>{"dm", 0.1},
    Named<double>{"cm", 0.01},       Named<double>{"mm", 0.001},  Named<double>{"um", 1e-6},
    Named<double>{"km", 1000},       Named<double>{"in", 0.0254}, Named<double>{"inch", 0.0254},
    Named<double>{"inches", 0.0254}, Named<double>{"ft", 0.3048}};

constexpr const char* unit_of_the_map = "map";

}  // namespace

std::optional<double> metres_per_unit(const std::string& unit) { return value_of(units, lower_case(unit)); }

std::string unit_of_format(const std::filesystem::path& path) {
  const std::string ending = lower_ending(path);
  if (ending == ".3mf") return unit_of_3mf(InputFile(path));
  return ending == ".gltf" || ending == ".glb" ? "m" : "";
}

std::optional<double> unit_factor(const std::string& from, const std::string& to) {
  if (from == to) return from.empty() ? std::nullopt : std::optional<double>(1);
  const std::optional<double> from_metres = metres_per_unit(from), to_metres = metres_per_unit(to);
  if (!from_metres || !to_metres) return std::nullopt;
  if (*from_metres == *to_metres) return 1;
  // The shorter length divides, so that 1 m is 100 cm and not 99.99….
  const double factor = *from_metres / *to_metres, back = *to_metres / *from_metres;
  const double rounded = std::round(factor > 1 ? factor : back);
  const bool is_whole = std::abs((factor > 1 ? factor : back) - rounded) < 1e-9 * rounded;
  if (!is_whole) return factor;
  return factor > 1 ? rounded : 1 / rounded;
}

double required_unit_factor(const std::string& from, const std::string& to) {
  if (const std::optional<double> factor = unit_factor(from, to)) return *factor;
  const std::string& unknown = metres_per_unit(from) ? to : from;
  throw InvalidInput("the unit \"" + unknown +
                     "\" is not known; m, dm, cm, mm, um, km, in and ft are, so "
                     "nothing is converted from \"" +
                     from + "\" to \"" + to + "\"");
}

double scale_to_unit(const std::filesystem::path& path, const std::string& unit) {
  return unit_factor(unit_of_format(path), unit).value_or(1);
}

double product_scale(const std::filesystem::path& path, const std::string& map_unit,
                     const std::string& given) {
  if (given.empty()) return scale_to_unit(path, map_unit);
  return given == unit_of_the_map ? 1 : required_unit_factor(given, map_unit);
}

std::string product_unit(const std::filesystem::path& path, const std::string& map_unit,
                         const std::string& given) {
  if (!given.empty() && given != unit_of_the_map) return given;
  const std::string own = given.empty() ? unit_of_format(path) : "";
  if (!own.empty()) return own;
  return metres_per_unit(map_unit) ? map_unit : "";
}

void require_unit_of_format(const std::filesystem::path& model, const std::string& unit) {
  require_unit_of_anchors(model.string(), unit.empty() ? "" : unit_of_format(model), unit);
}

void require_unit_of_anchors(const std::string& model, const std::string& own, const std::string& unit) {
  if (own.empty() || unit.empty()) return;
  const std::optional<double> metres = metres_per_unit(unit);
  const double own_metres = *metres_per_unit(own);
  if (metres == own_metres) return;
  const std::string ending = lower_ending(model);
  const bool is_gltf = ending == ".gltf" || ending == ".glb";
  std::string message = model + (own == "m" ? ": is in metres" : ": is in " + own) +
                        (is_gltf ? ", as every glTF file" : ", as its file says") +
                        ", but the anchors are in " + unit;
  if (metres)
    message += "; multiply their coordinates by " + format_number(*metres / own_metres, 4) +
               " and say \"units\": \"" + own + "\"";
  throw InvalidInput(message);
}

}  // namespace bespoke
