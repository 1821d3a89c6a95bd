#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <nlohmann/json.hpp>

#include "bespoke/apply/unit_check.h"
#include "bespoke/asset/asset_io.h"
#include "bespoke/asset/model_distances.h"
#include "bespoke/clearance/product_clearer.h"
#include "bespoke/mapping/scaled_map.h"
#include "bespoke/pipeline/certify_map.h"
#include "bespoke/pipeline/derive_map.h"
#include "bespoke/pipeline/summary_json.h"
#include "bespoke/product/format_unit.h"
#include "bespoke/product/posed_product.h"
#include "bespoke/product/product_io.h"
#include "bespoke/quality/mapping_quality.h"
#include "bespoke/report/inspection.h"
#include "bespoke/report/quality_report.h"
#include "loaded_asset.h"
#include "parts.h"
#include "released.h"

namespace bespoke::python {
namespace py = pybind11;
namespace fs = std::filesystem;
namespace {

std::shared_ptr<LoadedAsset> load(const fs::path& path, bool untrusted) {
  const py::gil_scoped_release release;
  return std::make_shared<LoadedAsset>(read_asset(path, {.untrusted = untrusted}));
}

void save(const LoadedAsset& map, const fs::path& path) {
  const py::gil_scoped_release release;
  write_asset(path, map.asset());
}

/// Of names that may be empty: the asset's own path, the mapping's own order.
MotionOptions motion(const LoadedAsset& map, const std::string& path, const std::string& order) {
  MotionOptions options{map.asset().path, MappingOrder::elastic_first};
  if (!order.empty()) options.order = required(mapping_orders, order, "order");
  if (!path.empty())
    options.path = required(rotation_paths, path, "path");
  else if (options.path == RotationPath::flow && options.order != MappingOrder::elastic_first)
    options.path = RotationPath::geodesic;
  return options;
}

PointArray image(LoadedAsset& map, const PointArray& points, double t, const std::string& path,
                 const std::string& order) {
  require_rows_of_three(points, "points");
  PointArray image = make_points(points.shape(0));
  const PointSpans spans{numbers(points), {image.mutable_data(), static_cast<std::size_t>(image.size())}};
  const MotionOptions options = motion(map, path, order);
  released(py::none(), [&](const Progress& progress) {
    return apply_points(map.carrier(), map.asset().target_from_source, spans, {t, options, progress});
  });
  return image;
}

PointArray inverse(LoadedAsset& map, const PointArray& points) {
  const Points y = to_points(points, "points");
  return to_array(released(py::none(), [&](const Progress&) { return map.preimages(y); }));
}

py::array_t<double> jacobian(LoadedAsset& map, const PointArray& points, double t) {
  const Points x = to_points(points, "points");
  const Points found = released(py::none(), [&](const Progress&) {
    return motion_jacobian(map.carrier(), map.asset().target_from_source, x, {t}, {map.asset().path}).front();
  });
  // Columns of the library's matrices become rows of NumPy's.
  py::array_t<double> result({x.cols(), Eigen::Index{3}, Eigen::Index{3}});
  auto entry = result.mutable_unchecked<3>();
  for (Eigen::Index n = 0; n < x.cols(); ++n)
    for (Eigen::Index i = 0; i < 3; ++i)
      for (Eigen::Index j = 0; j < 3; ++j) entry(n, i, j) = found(i, 3 * n + j);
  return result;
}

std::string check(const LoadedAsset& map, double t, const py::object& callback) {
  return released(callback, [&](const Progress& progress) {
    return to_json(certify_map(map.asset(), t, progress)).dump();
  });
}

ValuePrecision precision(bool half) { return half ? ValuePrecision::half : ValuePrecision::single; }

std::shared_ptr<LoadedAsset> inverted(const LoadedAsset& map, const py::object& tolerance, bool half,
                                      const py::object& callback) {
  const BakeOptions options =
      derived_bake(to_length(tolerance, "tolerance"), tolerance_of_inverse(map.asset()), precision(half));
  return released(callback, [&](const Progress& progress) {
    return std::make_shared<LoadedAsset>(invert_map(map.asset(), options, progress).asset);
  });
}

std::shared_ptr<LoadedAsset> composed(const LoadedAsset& first, const LoadedAsset& second,
                                      const py::object& tolerance, bool half, bool any_models,
                                      const py::object& callback) {
  const BakeOptions options =
      derived_bake(to_length(tolerance, "tolerance"), tolerance_of_composed(first.asset(), second.asset()),
                   precision(half));
  const MeetingModels meeting = any_models ? MeetingModels::may_differ : MeetingModels::must_be_the_same;
  return released(callback, [&](const Progress& progress) {
    return std::make_shared<LoadedAsset>(
        compose_maps(first.asset(), second.asset(), options, meeting, progress).asset);
  });
}

struct ClearedRequest {
  fs::path product;
  std::vector<fs::path> layers;  ///< below it, from the inside to the outside
  std::vector<RigidPart> parts;
  std::string unit;
  ModelPose pose;
  std::string clearance;
  std::vector<double> times;
};

/// As `bespoke apply --clearance --layers`.
std::shared_ptr<const ElasticMap> cleared_map(const Asset& asset, std::shared_ptr<const ElasticMap> elastic,
                                              const ClearedRequest& request,
                                              std::optional<ProductClearance>& found) {
  if (request.times != std::vector<double>{1})
    throw InvalidInput("clearance is kept from the target, where t is 1; leave out t");
  const ModelSizes sizes{asset.record.source.box.diagonal().norm(),
                         asset.record.target.box.diagonal().norm()};
  const std::optional<ClearanceRule> rule = parse_clearance(request.clearance, sizes);
  if (!rule)
    throw InvalidInput("clearance is \"off\", " + std::string(clearance_grammar) + "; not '" +
                       request.clearance + "'");
  const ClearanceMap map{std::move(elastic), asset.target_from_source, model_distances(asset), sizes};
  ProductClearer clearer(*rule, ProductClearer::Products::layers);
  const auto corrected = [&](const fs::path& file, const std::vector<RigidPart>& parts) {
    return clearer.corrected(
        read_worn_product(file, parts, product_scale(file, asset.record.unit, request.unit), request.pose),
        map);
  };
  for (const fs::path& layer : request.layers) corrected(layer, {});
  std::shared_ptr<const ElasticMap> result = corrected(request.product, request.parts);
  found = clearer.found().back();
  return result;
}

/// The report of `bespoke apply`, JSON.
std::string apply_file(LoadedAsset& map, const fs::path& product, const std::vector<fs::path>& outputs,
                       const std::vector<double>& times, const std::string& path, const std::string& order,
                       const std::vector<std::string>& rigid, const std::vector<std::string>& similar,
                       const py::object& refine, const std::string& unit, const std::string& pose,
                       const std::string& clearance, const std::vector<fs::path>& layers,
                       const py::object& callback) {
  const AssetRecord& record = map.asset().record;
  const double scale = product_scale(product, record.unit, unit);
  ApplyToProductOptions options;
  options.motion = motion(map, path, order);
  options.pose = required(model_poses, pose, "pose");
  options.times = times;
  for (const std::string& name : rigid) options.parts.push_back({name, PartMotion::rigid});
  for (const std::string& name : similar) options.parts.push_back({name, PartMotion::similar});
  if (const auto length = to_length(refine, "refine"))
    options.refine = length->in_mesh_units(record.source.box.diagonal().norm()) / scale;
  if (unit.empty()) options.model_box = Box(record.source.box.min() / scale, record.source.box.max() / scale);
  // Not the owner: the map outlives the call.
  const std::shared_ptr<const ElasticMap> carrier(std::shared_ptr<void>(), &map.carrier());
  if (clearance == "off" && !layers.empty())
    throw InvalidInput(
        "layers are kept under the product where there is a clearance: \"keep\", \"same\" or a length");
  AppliedProduct applied{product.filename().string(), {}, {}};
  applied.summary = released(callback, [&](const Progress& progress) {
    options.progress = progress;
    std::shared_ptr<const ElasticMap> elastic = carrier;
    if (clearance != "off")
      elastic = cleared_map(map.asset(), carrier,
                            {product, layers, options.parts, unit, options.pose, clearance, times},
                            applied.clearance);
    return apply_to_product(product, outputs, *in_other_unit(elastic, scale),
                            in_other_unit(map.asset().target_from_source, scale), options);
  });
  const double seconds = applied.summary.points.seconds;
  return apply_report({std::move(applied)}, times, seconds);
}

std::string measure(LoadedAsset& map, const py::tuple& source, const py::tuple& target,
                    const std::optional<PointCloudSummary>& target_cloud,
                    const std::vector<fs::path>& products, const std::string& unit, const std::string& pose,
                    const py::object& callback) {
  const ModelPose known_pose = required(model_poses, pose, "pose");
  const auto model = [&](const py::tuple& arrays, const std::string& role) {
    TriangleMesh mesh = to_mesh(arrays[0].cast<PointArray>(), arrays[1].cast<FaceArray>(), role);
    require_valid(mesh, role);
    mesh.vertices *= unit_factor(arrays[2].cast<std::string>(), map.asset().record.unit).value_or(1);
    return mesh;
  };
  const auto require = [](const std::string& hash, const ModelRecord& record, const std::string& role) {
    if (hash != record.hash)
      throw InvalidInput(role + ": is not the one that the map was made of (other vertices or faces)");
  };
  const AssetRecord& record = map.asset().record;
  const TriangleMesh from = model(source, "source"), to = model(target, "target");
  require(content_hash(from), record.source, "source");
  require(target_cloud ? target_cloud->hash : content_hash(to), record.target, "target");
  const auto [a, b] = anchor_points(record);
  return released(callback, [&](const Progress& progress) {
    std::vector<NamedProduct> named;
    std::vector<std::string> names;
    for (const fs::path& path : products) {
      const Product product = read_product(path, known_pose);
      named.push_back({path.string(),
                       {product_scale(path, record.unit, unit) * product.vertices, triangulated(product)},
                       product.line_edges});
      if (unit.empty())
        require_unit_of_map(path.string(), named.back().mesh.vertices, map.certified_map(),
                            record.source.box);
      names.push_back(path.filename().string());
    }
    const MappingQuality quality = mapping_quality(
        {from, to, map.certified_map(), map.asset().target_from_source, a, b, named}, {}, progress);
    return quality_json(quality, names, record.unit);
  });
}

}  // namespace

void add_map(py::module_& engine) {
  py::class_<LoadedAsset, std::shared_ptr<LoadedAsset>>(engine, "Map")
      .def_static("load", &load, py::arg("path"), py::arg("untrusted"))
      .def("save", &save, py::arg("path"))
      .def("image", &image, py::arg("points"), py::arg("t"), py::arg("path"), py::arg("order"))
      .def("inverse", &inverse, py::arg("points"))
      .def("jacobian", &jacobian, py::arg("points"), py::arg("t"))
      .def("check", &check, py::arg("t"), py::arg("progress"))
      .def("inverted", &inverted, py::arg("tolerance"), py::arg("half"), py::arg("progress"))
      .def("composed", &composed, py::arg("second"), py::arg("tolerance"), py::arg("half"),
           py::arg("any_models"), py::arg("progress"))
      .def("apply", &apply_file, py::arg("product"), py::arg("outputs"), py::arg("times"), py::arg("path"),
           py::arg("order"), py::arg("rigid"), py::arg("similar"), py::arg("refine"), py::arg("unit"),
           py::arg("pose"), py::arg("clearance"), py::arg("layers"), py::arg("progress"))
      .def("measure", &measure, py::arg("source"), py::arg("target"), py::arg("target_cloud"),
           py::arg("products"), py::arg("unit"), py::arg("pose"), py::arg("progress"))
      .def("info", [](const LoadedAsset& map) { return inspection_json(map.asset()); });
}

}  // namespace bespoke::python
