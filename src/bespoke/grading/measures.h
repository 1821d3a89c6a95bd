#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "bespoke/apply/apply_mapping.h"
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
  std::variant<Plane, AnchorLine> what;  ///< of a plane, its section about its point
};

struct Measures {
  std::string unit;  ///< empty when the file does not say
  std::vector<Measure> measures;
};

/// Reads {"units": …, "measures": [{"name": …, "plane": {"point": [x,y,z], "normal": [x,y,z]}} or
/// {"name": …, "loop": [point or anchor's name, …]} or "path" instead of "loop", …]}. Throws FileError, or
/// FormatError naming the file, the measure and what is wrong; a key that is none of these is wrong.
Measures read_measures(const std::filesystem::path& path);

/// The places of anchors on a model by their names, mesh units.
using AnchorPlaces = std::map<std::string, Vector3>;

/// A measure as a line over the source, 3×n, mesh units.
struct MeasureLine {
  std::string name;
  Points points;
  bool closed = false;
  std::optional<AnchorLine> through;  ///< of a measure through anchors
};

/// Throws InvalidInput naming the measure whose plane has no closed section, whose line finds no way over the
/// surface, or whose anchor is not among `anchors`.
std::vector<MeasureLine> measure_lines(const std::vector<Measure>& measures, const TriangleMesh& source,
                                       const AnchorPlaces& anchors);

/// A size's own model, with the anchors' places on it.
struct SizeModel {
  TriangleMesh mesh;
  AnchorPlaces anchors;
};

/// A measure of a size's own model. `image` says where the map takes points of the source. A girth is that of
/// the plane nearest to the line's image, in its section about the image's middle; a line through anchors
/// goes over the model through their places there, and the images of its other points. Empty where the model
/// has no such section or line.
std::optional<double> length_on(const SizeModel& model, const MeasureLine& line, const ImageOfPoints& image);

}  // namespace bespoke
