#include "numpy_points.h"

#include <algorithm>

#include "bespoke/error.h"

namespace bespoke::python {
namespace py = pybind11;

void require_rows_of_three(const py::array& array, const std::string& what) {
  if (array.ndim() == 2 && array.shape(1) == 3) return;
  std::string shape;
  for (py::ssize_t axis = 0; axis < array.ndim(); ++axis)
    shape += (axis > 0 ? ", " : "") + std::to_string(array.shape(axis));
  throw InvalidInput(what + ": an array of shape (n, 3) is wanted, this one has (" + shape + ")");
}

std::span<const double> numbers(const PointArray& points) {
  return {points.data(), static_cast<std::size_t>(points.size())};
}

PointArray make_points(py::ssize_t count) { return PointArray({count, py::ssize_t{3}}); }

Points to_points(const PointArray& points, const std::string& what) {
  require_rows_of_three(points, what);
  return Eigen::Map<const Points>(points.data(), 3, points.shape(0));
}

PointArray to_array(const Points& points) {
  PointArray array = make_points(points.cols());
  std::copy_n(points.data(), points.size(), array.mutable_data());
  return array;
}

py::array_t<double> to_array(const std::vector<double>& values) {
  return py::array_t<double>(static_cast<py::ssize_t>(values.size()), values.data());
}

TriangleMesh to_mesh(const PointArray& vertices, const FaceArray& faces, const std::string& what) {
  require_rows_of_three(faces, what + ": faces");
  return {to_points(vertices, what + ": vertices"), Eigen::Map<const Faces>(faces.data(), 3, faces.shape(0))};
}

py::tuple to_arrays(const TriangleMesh& mesh) {
  FaceArray faces({mesh.faces.cols(), py::ssize_t{3}});
  std::copy_n(mesh.faces.data(), mesh.faces.size(), faces.mutable_data());
  return py::make_tuple(to_array(mesh.vertices), faces);
}

}  // namespace bespoke::python
