// Lamps written in Python: for trying one out before it becomes a kind.
#pragma once

#include <pybind11/pybind11.h>

#include "python/bindings/call.h"
#include "tools/runs/options.h"

namespace photorque::python {

// The Python class Lamp.
void bind_lamp(py::module_& module);

// Lets the run of `options` shine with a list of Lamps too. What their functions raise ends `call`.
void add_lamps(RunOptions& options, const py::iterable& lamps, const Call& call);

}  // namespace photorque::python
