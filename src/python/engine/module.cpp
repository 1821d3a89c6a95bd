#include "parts.h"

PYBIND11_MODULE(_engine, engine) {
  using namespace bespoke::python;
  engine.doc() = "The library as the package's modules use it; see `bespoke`.";
  add_errors(engine);
  add_files(engine);
  add_map(engine);
  add_fit(engine);
}
