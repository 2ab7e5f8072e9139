// budget() and balance(): torques on the platform at one state, and its mass distribution.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "python/bindings/arrays.h"
#include "python/bindings/bind.h"
#include "python/bindings/call.h"
#include "python/bindings/experiment.h"
#include "python/bindings/results.h"
#include "tools/verbs/attitude/balance.h"
#include "tools/verbs/attitude/budget.h"

namespace photorque::python {
namespace {

BudgetRun budget_of(const ExperimentHandle& experiment) {
  const Call call(experiment.options.experiment, py::none(), py::none());
  return call.run([&] { return run_budget(experiment.options); });
}

BalanceOutcome balance_of(const ExperimentHandle& experiment,
                          const std::filesystem::path& recording) {
  const Call call(experiment.options.experiment, py::none(), py::none());
  return call.run([&] { return run_balance(experiment.options, {recording}); });
}

void bind_budget(py::module_& module) {
  py::class_<BudgetEntry>(module, "BudgetEntry", "A disturbance at the state of a budget.")
      .def_readonly("kind", &BudgetEntry::kind, "Kind of the disturbance, as in the experiment.")
      .def_readonly("name", &BudgetEntry::name, "Name of the disturbance; unique in the budget.")
      .def_property_readonly(
          "torque_body_N_m",
          [](const BudgetEntry& entry) { return copy_of(entry.torque_body_N_m); },
          "Largest torque within one second, about the centre of rotation, body axes [N m], shape "
          "(3,).")
      .def_readonly("angle_after_minute_rad", &BudgetEntry::angle_after_minute_rad,
                    "Angle of rotation from rest in 60 s under the mean torque alone [rad].")
      .def_readonly("angle_after_hour_rad", &BudgetEntry::angle_after_hour_rad,
                    "The angle after 3600 s [rad].")
      .def_readonly("angle_after_day_rad", &BudgetEntry::angle_after_day_rad,
                    "The angle after 86400 s [rad].");
  auto type = py::class_<BudgetRun>(module, "Budget",
                                    "Every disturbance torque at one state, largest first.");
  add_result(type, "budget");
  type.def_property_readonly(
      "entries", [](const BudgetRun& run) { return run.budget.entries; },
      "List of BudgetEntry, largest torque first.");
  module.def("budget", &budget_of, py::arg("experiment"),
             "Every disturbance torque at the state of [budget], largest first, with the published "
             "figures.");
}

}  // namespace

void bind_platform(py::module_& module) {
  bind_budget(module);
  auto type =
      py::class_<BalanceOutcome>(module, "Balance", "Centre of mass, fitted to a recording.");
  add_result(type, "balance");
  type.def_property_readonly(
          "offset_body_m",
          [](const BalanceOutcome& self) { return copy_of(self.balance.offset_body_m); },
          "Centre of mass relative to the centre of rotation, body axes [m], shape (3,).")
      .def_property_readonly(
          "standard_error_m",
          [](const BalanceOutcome& self) { return copy_of(self.balance.sigma_m); },
          "Standard error of offset_body_m [m], shape (3,); infinite along an axis that the "
          "recording does not determine.");
  module.def("balance", &balance_of, py::arg("experiment"), py::arg("recording"),
             "The centre of mass from a recording, and the displacements of the balancing masses.");
}

}  // namespace photorque::python
