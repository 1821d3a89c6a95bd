#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <exception>

#include "bespoke/progress.h"

namespace bespoke::python {

/// The progress of a call that runs without Python's lock: at every step the lock is taken, signals are
/// looked at and `callback(stage, done, total)` is called, unless it is None. What either raises stops the
/// work.
class PythonProgress {
 public:
  explicit PythonProgress(pybind11::object callback) : callback_(std::move(callback)) {}

  Progress progress();

  /// Throws what the callback or a signal raised, if anything.
  void rethrow() const;

 private:
  void look(std::string_view stage, std::size_t done, std::size_t total);

  pybind11::object callback_;
  std::atomic<bool> cancelled_ = false;
  std::exception_ptr raised_;
};

/// work(progress), without Python's lock.
template <class Work>
auto released(const pybind11::object& callback, const Work& work) {
  PythonProgress progress(callback);
  try {
    const pybind11::gil_scoped_release release;
    return work(progress.progress());
  } catch (const Interrupted&) {
    progress.rethrow();
    throw;
  }
}

}  // namespace bespoke::python
