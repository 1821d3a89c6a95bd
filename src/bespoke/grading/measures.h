#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/quality/plane_section.h"

namespace bespoke {

/// A line over the source's surface through points near it, each a place (mesh units) or an anchor's name.
struct AnchorLine {
  std::vector<std::variant<Vector3, std::string>> points;
  bool closed = false;
};

/// A girth or a length of a model, as it is named on a measuring sheet.
struct Measure {
  std::string name;
  std::variant<Plane, AnchorLine> what;  ///< a plane's girth is its longest closed section
};

struct Measures {
  std::string unit;  ///< empty when the file does not say
  std::vector<Measure> measures;
};

/// Reads {"unit": …, "measures": [{"name": …, "plane": {"point": [x,y,z], "normal": [x,y,z]}} or
/// {"name": …, "loop": [point or anchor's name, …]} or "path" instead of "loop", …]}. Throws FileError, or
/// FormatError naming the file and the measure.
Measures read_measures(const std::filesystem::path& path);

/// A measure as a line over the source, 3×n, mesh units.
struct MeasureLine {
  std::string name;
  Points points;
  bool closed = false;
};

/// Planes by their sections; anchor lines by a chain of closest points of the surface, a hundredth of its
/// diagonal apart or less. Throws InvalidInput naming the measure whose plane has no closed section, or an
/// anchor that `anchors` lacks.
std::vector<MeasureLine> measure_lines(const std::vector<Measure>& measures, const TriangleMesh& source,
                                       const std::map<std::string, Vector3>& anchors);

/// The girth of another surface where the plane nearest to the points (3×n) cuts it: of its closed sections
/// that whose centre is nearest to theirs; 0 when there is none.
double girth_near(const TriangleMesh& mesh, const Points& points);

}  // namespace bespoke
