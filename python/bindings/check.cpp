// check(): validation of an experiment without a run.
#include <pybind11/stl.h>

#include "python/bindings/bind.h"
#include "python/bindings/call.h"
#include "python/bindings/experiment.h"
#include "tools/verbs/check.h"

namespace photorque::python {
namespace {

CheckReport check_of(const ExperimentHandle& experiment) {
  const Call call(experiment.options.experiment, py::none(), py::none());
  return call.run([&] { return run_check(experiment.options); });
}

// Performs the tasks common to all runs (options, callbacks, release of the lock) and nothing else.
RunOptions nothing(const ExperimentHandle& experiment, int threads, const py::object& seed,
                   const py::object& progress, const py::object& log) {
  const RunOptions options = experiment.with(threads, seed);
  const Call call(options.experiment, progress, log);
  return call.run([&] {
    const Console console = call.console();
    return options;
  });
}

}  // namespace

void bind_check(py::module_& module) {
  py::class_<CheckReport>(module, "CheckReport",
                          "Errors of an experiment, and the commands that can run with it.")
      .def_property_readonly(
          "commands",
          [](const CheckReport& report) {
            py::dict commands;
            for (const CheckReport::Command& one : report.commands) {
              commands[py::str(one.name)] = one.what;
            }
            return commands;
          },
          "Description of each command that can run, by its name.")
      .def_property_readonly(
          "mistakes",
          [](const CheckReport& report) {
            py::list lines;
            for (const InputError& mistake : report.mistakes) lines.append(mistake.what());
            return lines;
          },
          "Errors, one line each: the first one of every table.")
      .def_readonly("notes", &CheckReport::notes, "Assumptions of the readers, one line each.");
  module.def("check", &check_of, py::arg("experiment"),
             "Reads the experiment as every command does, without running one.");
  // For the benchmark of calls.
  const py::class_<RunOptions> options(module, "_Nothing");
  module.def("_nothing", &nothing, py::arg("experiment"), py::kw_only(), py::arg("threads") = 0,
             py::arg("seed") = py::none(), py::arg("progress") = py::none(),
             py::arg("log") = py::none());
}

}  // namespace photorque::python
