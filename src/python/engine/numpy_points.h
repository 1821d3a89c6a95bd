#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <span>
#include <string>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke::python {

/// n×3 doubles in rows, which are the 3×n columns of the library: taken as it lies where NumPy has it so,
/// converted otherwise.
using PointArray = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;
using FaceArray = pybind11::array_t<int, pybind11::array::c_style | pybind11::array::forcecast>;

/// Throws InvalidInput, naming `what` and its shape, unless the array is n×3.
void require_rows_of_three(const pybind11::array& array, const std::string& what);

/// The numbers of an n×3 array; it must outlive them.
std::span<const double> numbers(const PointArray& points);

/// A new n×3 array.
PointArray make_points(pybind11::ssize_t count);

/// Copies between the two.
Points to_points(const PointArray& points, const std::string& what);
PointArray to_array(const Points& points);
pybind11::array_t<double> to_array(const std::vector<double>& values);

TriangleMesh to_mesh(const PointArray& vertices, const FaceArray& faces, const std::string& what);
pybind11::tuple to_arrays(const TriangleMesh& mesh);

}  // namespace bespoke::python
