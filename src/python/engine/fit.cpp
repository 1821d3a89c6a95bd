#include <pybind11/stl.h>

#include <algorithm>

#include "bespoke/anchors/anchors.h"
#include "bespoke/anchors/size_ratio.h"
#include "bespoke/elastic/elastic_methods.h"
#include "bespoke/error.h"
#include "bespoke/pipeline/fit_mapping.h"
#include "bespoke/pipeline/map_request.h"
#include "bespoke/pipeline/model_units.h"
#include "bespoke/product/format_unit.h"
#include "bespoke/stopwatch.h"
#include "loaded_asset.h"
#include "parts.h"
#include "released.h"

namespace bespoke::python {
namespace py = pybind11;
namespace {

/// Of a text in JSON, which Python made of its objects.
Anchors to_anchors(const std::string& text) {
  try {
    return parse_anchors(text, "anchors");
  } catch (const FormatError& error) {
    throw InvalidInput(error.what());
  }
}

/// Options by the command's names, with _ for -; all of them are taken out of `given`.
class RequestReader {
 public:
  explicit RequestReader(const py::dict& given) : given_(given) {}

  MapRequest read() {
    MapRequest request;
    take("surface_fit", surface_fits, request.surface_fit);
    take("boundaries", boundary_rules, request.boundaries);
    take("elastic", elastic_methods, request.elastic);
    take("guides", guided_maps, request.guides);
    take("path", rotation_paths, request.path);
    take("nodes", node_values, request.nodes);
    take("max_stretch", request.max_stretch);
    take("max_squeeze", request.max_squeeze);
    take("steps", request.steps);
    take("max_memory", request.max_memory);
    take("anchor_sigma", request.anchor_sigma, LengthRange::not_negative);
    take("lambda_", request.lambda);
    take("tolerance", request.tolerance);
    take("fit_tolerance", request.fit_tolerance);
    take("voxel_size", request.voxel_size);
    take("contact_gap", request.contact_offset, LengthRange::not_negative);
    request.keep_exact = flag("keep_exact");
    request.half = flag("half");
    request.strict = flag("strict");
    request.as_given = flag("as_given");
    request.any_size = flag("any_size");
    request.any_anchors = flag("any_anchors");
    request.paper = flag("paper");
    return request;
  }

 private:
  py::object value(const char* name) const { return given_.attr("get")(name); }

  bool flag(const char* name) const { return py::bool_(value(name)); }

  template <class Table, class Value>
  void take(const char* name, const Table& table, std::optional<Value>& option) const {
    if (const py::object given = value(name); !given.is_none())
      option = required(table, given.cast<std::string>(), name);
  }
  template <class Number>
  void take(const char* name, std::optional<Number>& option) const {
    option = value(name).cast<std::optional<Number>>();
  }
  void take(const char* name, std::optional<Length>& option,
            LengthRange range = LengthRange::positive) const {
    option = to_length(value(name), name, range);
  }

  const py::dict& given_;
};

void require_usable(const MapRequest& request, const RequestInputs& inputs) {
  if (request.max_stretch && !(*request.max_stretch > 1))
    throw InvalidInput("max_stretch " + std::to_string(*request.max_stretch) + " must be greater than 1");
  if (request.steps && (*request.steps < 1 || *request.steps > 100))
    throw InvalidInput("steps " + std::to_string(*request.steps) + " must be between 1 and 100");
  if (std::optional<InapplicableOption> inapplicable = inapplicable_option(request, inputs)) {
    std::replace(inapplicable->name.begin(), inapplicable->name.end(), '-', '_');
    throw InvalidInput(inapplicable->name + ": " + inapplicable->reason);
  }
}

/// (map, fitted vertices n×3 in the target frame, confidence n, report as JSON)
py::tuple fit(const py::tuple& source_arrays, const py::tuple& target_arrays,
              const std::optional<PointCloudSummary>& target_cloud, const std::string& anchors_text,
              const py::object& fitted_arrays, bool add_corners, const py::dict& options,
              const py::object& callback) {
  const auto mesh = [](const py::tuple& arrays, const std::string& role) {
    TriangleMesh made = to_mesh(arrays[0].cast<PointArray>(), arrays[1].cast<FaceArray>(), role);
    require_valid(made, role);
    return made;
  };
  TriangleMesh source = mesh(source_arrays, "source"), target = mesh(target_arrays, "target");
  std::optional<TriangleMesh> fitted;
  if (!fitted_arrays.is_none()) fitted = mesh(fitted_arrays, "fitted");
  const MapRequest request = RequestReader(options).read();
  Anchors anchors = to_anchors(anchors_text);
  const auto unit = [&](const char* name) {
    return py::object(options.attr("get")(name, "")).cast<std::string>();
  };
  const UnitPlan units = bring_to_one_unit({unit("unit"), unit("source_unit"), unit("target_unit")}, anchors);
  source.vertices *= units.source_scale;
  target.vertices *= units.target_scale;
  if (fitted) fitted->vertices *= unit_factor(unit("fitted_unit"), units.unit).value_or(1);
  const bool has_anchors = !anchors.pairs.empty() || !anchors.curves.empty() || !anchors.patches.empty();
  require_usable(request, {has_anchors, fitted.has_value(), add_corners});
  const double size = diagonal(source.vertices),
               size_scale = power_of_two_scale(size_ratio(anchors, source, target));
  estimate_anchor_sigmas(anchors, request, size, size_scale);
  if (add_corners) add_box_corners(anchors, source.vertices, target.vertices);

  const Stopwatch watch;
  const Problem input{source, target, anchors, fitted ? &*fitted : nullptr,
                      target_cloud ? &*target_cloud : nullptr};
  MadeMap made = released(callback, [&](const Progress& progress) {
    return make_map(input, make_options(request, size, size_scale), progress);
  });
  const std::string report = fit_report(input, made, watch.seconds());
  const Points placed = made.fit->target_from_source * made.fit->fitted_vertices;
  return py::make_tuple(std::make_shared<LoadedAsset>(std::move(made.asset)), to_array(placed),
                        to_array(made.fit->confidence), report);
}

}  // namespace

void add_fit(py::module_& engine) {
  engine.def("fit", &fit, py::arg("source"), py::arg("target"), py::arg("target_cloud"), py::arg("anchors"),
             py::arg("fitted"), py::arg("add_corners"), py::arg("options"), py::arg("progress"));
}

}  // namespace bespoke::python
