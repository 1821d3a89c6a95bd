#include "pattern_options.h"

#include <cmath>
#include <cstdio>

#include "bespoke/anchors/anchors.h"
#include "bespoke/error.h"
#include "bespoke/product/format_unit.h"

namespace bespoke::command {

CLI::Option* add_millimetres(CLI::App& app, const std::string& name, double& value, const CLI::Range& range,
                             const std::string& description) {
  return app.add_option(name, value, description)->check(range)->type_name("MM");
}

void add_seam_allowance(CLI::App& app, double& millimetres) {
  add_millimetres(app, "--seam-allowance", millimetres, CLI::Range(0.0, 200.0),
                  "Millimetres outside the sew line (default: 0)");
}

void set_eases(const std::vector<std::string>& texts, PatternOptions& options) {
  for (const std::string& text : texts) {
    int seam = 0;
    double value = 0;
    char rest = 0;
    if (std::sscanf(text.c_str(), "%lf%c", &value, &rest) == 1 && std::isfinite(value) && value >= 0)
      options.flatten.seam_tolerance = value;
    else if (std::sscanf(text.c_str(), "%d=%lf%c", &seam, &value, &rest) == 2 && std::isfinite(value))
      options.eases[seam] = value;
    else
      throw CLI::ValidationError("--ease", "\"" + text +
                                               "\" must be millimetres, 0 or more, or a seam's number and "
                                               "millimetres: 1.5 or 3=20");
  }
}

std::vector<SurfaceMark> marks_of_anchors(const std::string& path, const std::string& unit) {
  const Anchors anchors = read_anchors(path);
  const std::string& own = anchors.unit.empty() ? unit : anchors.unit;
  if (own.empty())
    throw InvalidInput(path + ": it does not say the unit of its coordinates; add \"units\": \"cm\"");
  const double factor = required_unit_factor(own, "mm");
  std::vector<SurfaceMark> marks;
  for (const AnchorPair& pair : anchors.pairs) marks.push_back({pair.name, factor * pair.a});
  for (const AnchorCurve& curve : anchors.curves) {
    if (curve.closed || curve.a.cols() == 0) continue;
    marks.push_back({curve.name, factor * curve.a.col(0)});
    marks.push_back({curve.name, factor * curve.a.col(curve.a.cols() - 1)});
  }
  return marks;
}

}  // namespace bespoke::command
