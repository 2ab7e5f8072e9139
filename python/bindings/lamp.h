// Lamps written in Python, for experiments before a new kind is implemented.
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <optional>

#include "python/bindings/call.h"
#include "python/bindings/experiment.h"
#include "tools/runs/options.h"

namespace photorque::python {

// The Python class Lamp.
void bind_lamp(py::module_& module);

// Adds a list of Lamps to the run of `options`. An exception in their functions ends `call`.
void add_lamps(RunOptions& options, const py::iterable& lamps, const Call& call);

// Defines the Python function of a traced run with the common arguments. The function returns the
// result of `run(options, console)`.
template <class Run>
void def_traced(py::module_& module, const char* name, const Run& run, const char* doc) {
  module.def(
      name,
      [run](const ExperimentHandle& experiment, int threads, const py::object& seed,
            std::optional<double> target_error, std::optional<double> max_time_s,
            const py::iterable& lamps, const py::object& progress, const py::object& log) {
        RunOptions options = experiment.with(threads, seed);
        options.target_error = target_error;
        options.max_time_s = max_time_s;
        const Call call(options.experiment, progress, log);
        add_lamps(options, lamps, call);
        return call.run([&] { return run(options, call.console()); });
      },
      py::arg("experiment"), py::kw_only(), py::arg("threads") = 0, py::arg("seed") = py::none(),
      py::arg("target_error") = py::none(), py::arg("max_time_s") = py::none(),
      py::arg("lamps") = py::list(), py::arg("progress") = py::none(), py::arg("log") = py::none(),
      doc);
}

}  // namespace photorque::python
