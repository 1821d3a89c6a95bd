#pragma once

#include <pybind11/pybind11.h>

namespace bespoke::python {

// What the module consists of, one source each.
void add_errors(pybind11::module_& engine);
void add_files(pybind11::module_& engine);
void add_map(pybind11::module_& engine);
void add_fit(pybind11::module_& engine);

}  // namespace bespoke::python
