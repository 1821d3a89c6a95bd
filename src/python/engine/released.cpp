#include "released.h"

namespace bespoke::python {
namespace py = pybind11;

Progress PythonProgress::progress() {
  return {.report = [this](std::string_view stage, std::size_t done,
                           std::size_t total) { look(stage, done, total); },
          .cancelled = [this] { return cancelled_.load(); }};
}

void PythonProgress::look(std::string_view stage, std::size_t done, std::size_t total) {
  const py::gil_scoped_acquire acquire;
  try {
    // A signal that arrived meanwhile, Ctrl-C for instance, becomes its exception here.
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!callback_.is_none()) callback_(py::str(stage.data(), stage.size()), done, total);
  } catch (const py::error_already_set&) {
    raised_ = std::current_exception();
    cancelled_ = true;
  }
}

void PythonProgress::rethrow() const {
  if (raised_) std::rethrow_exception(raised_);
}

}  // namespace bespoke::python
