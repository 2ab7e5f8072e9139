// fit_cell(): the parameters of a solar cell from measurements.
#include "python/bindings/bind.h"
#include "python/bindings/call.h"
#include "python/bindings/experiment.h"
#include "python/bindings/results.h"
#include "tools/verbs/fit_cell.h"

namespace photorque::python {
namespace {

struct CellFit {
  RunResult result;
};

CellFit fit_cell(const ExperimentHandle& experiment, const py::object& log) {
  const Call call(experiment.options.experiment, py::none(), log);
  return call.run([&] { return CellFit{run_fit_cell(experiment.options, call.console())}; });
}

}  // namespace

void bind_cell_fit(py::module_& module) {
  auto type = py::class_<CellFit>(module, "CellFit",
                                  "Parameters of a cell with their standard errors: its figures.");
  add_result(type, "fit-cell");
  module.def("fit_cell", &fit_cell, py::arg("experiment"), py::kw_only(),
             py::arg("log") = py::none(),
             "Solar cell parameters from the current-voltage sweeps or datasheet of [fit].");
}

}  // namespace photorque::python
