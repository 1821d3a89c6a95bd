#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>

#include "bespoke/anchors/anchor_files.h"
#include "bespoke/cloud/target_model.h"
#include "bespoke/error.h"
#include "bespoke/product/format_unit.h"
#include "bespoke/product/mesh_io.h"
#include "loaded_asset.h"
#include "numpy_points.h"
#include "parts.h"

namespace bespoke::python {
namespace py = pybind11;
namespace fs = std::filesystem;
namespace {

/// (vertices, faces, PointCloud or None, unit)
py::tuple read_mesh(const fs::path& path, const std::string& pose) {
  const ModelPose known = required(model_poses, pose, "pose");
  TargetModel model;
  {
    const py::gil_scoped_release release;
    model = read_target(path, known);
  }
  const py::tuple arrays = to_arrays(model.mesh);
  return py::make_tuple(arrays[0], arrays[1], model.cloud, unit_of_format(path));
}

void write_mesh(const fs::path& path, const PointArray& vertices, const FaceArray& faces,
                const std::string& unit) {
  const TriangleMesh mesh = to_mesh(vertices, faces, path.string());
  const py::gil_scoped_release release;
  write_triangle_mesh(path, mesh, unit);
}

/// As the text of a JSON file, whatever the file was.
std::string anchors_of_file(const fs::path& path) { return anchors_json(read_anchor_file(path)); }

}  // namespace

void add_files(py::module_& engine) {
  py::class_<PointCloudSummary>(engine, "PointCloud")
      .def_readonly("points", &PointCloudSummary::points)
      .def_readonly("spacing", &PointCloudSummary::spacing)
      .def_readonly("hash", &PointCloudSummary::hash)
      .def("__str__", [](const PointCloudSummary& summary) { return to_string(summary); });
  engine.def("read_mesh", &read_mesh, py::arg("path"), py::arg("pose"));
  engine.def("write_mesh", &write_mesh, py::arg("path"), py::arg("vertices"), py::arg("faces"),
             py::arg("unit"));
  engine.def("read_anchors", &anchors_of_file, py::arg("path"));
}

}  // namespace bespoke::python
