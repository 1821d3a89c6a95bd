#include "bespoke/error.h"

#include <string>

#include "parts.h"

namespace bespoke::python {
namespace py = pybind11;
namespace {

/// A class of exceptions of the package, and of Python's own where one says the same.
py::object add_class(py::module_& engine, const char* name, const char* meaning, const py::tuple& bases) {
  const std::string full = std::string("bespoke.") + name;
  const auto added = py::reinterpret_steal<py::object>(
      PyErr_NewExceptionWithDoc(full.c_str(), meaning, bases.ptr(), nullptr));
  engine.add_object(name, added);
  return added;
}

/// They live as long as the interpreter.
struct Classes {
  py::handle error, invalid_input, file_error, format_error, solver_error, memory_limit, interrupted;
};
Classes classes;

void translate(std::exception_ptr pointer) {
  const auto raise = [](const py::handle& kind, const std::exception& error) {
    PyErr_SetString(kind.ptr(), error.what());
  };
  try {
    if (pointer) std::rethrow_exception(pointer);
  } catch (const InvalidInput& error) {
    raise(classes.invalid_input, error);
  } catch (const FileError& error) {
    raise(classes.file_error, error);
  } catch (const FormatError& error) {
    raise(classes.format_error, error);
  } catch (const SolverError& error) {
    raise(classes.solver_error, error);
  } catch (const MemoryLimitError& error) {
    raise(classes.memory_limit, error);
  } catch (const Interrupted& error) {
    raise(classes.interrupted, error);
  } catch (const Error& error) {
    raise(classes.error, error);
  }
}

}  // namespace

void add_errors(py::module_& engine) {
  const auto of = [](PyObject* kind) { return py::reinterpret_borrow<py::object>(kind); };
  const py::object error = add_class(engine, "Error", "Root of everything that bespoke raises on purpose.",
                                     py::make_tuple(of(PyExc_Exception)));
  const auto add = [&](const char* name, const char* meaning, PyObject* python) {
    return add_class(engine, name, meaning, py::make_tuple(error, of(python))).release();
  };
  classes.error = py::object(error).release();
  classes.invalid_input =
      add("InvalidInput", "An argument or a mesh that the method cannot work with.", PyExc_ValueError);
  classes.file_error = add("FileError", "A file cannot be opened, read, written or renamed.", PyExc_OSError);
  classes.format_error =
      add("FormatError", "A file's content is not what its format allows.", PyExc_ValueError);
  classes.solver_error = add("SolverError", "A numerical method did not succeed.", PyExc_ArithmeticError);
  classes.memory_limit =
      add("MemoryLimitError", "The work would need more memory than allowed.", PyExc_MemoryError);
  classes.interrupted = add("Interrupted", "The caller requested a stop.", PyExc_RuntimeError);
  py::register_exception_translator(&translate);
}

}  // namespace bespoke::python
