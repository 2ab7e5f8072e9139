// One function per concept, defined in the file of that name.
#pragma once

#include <pybind11/pybind11.h>

namespace photorque::python {

void bind_light(pybind11::module_& module);      // trace, power, render, fit_cell
void bind_wrenches(pybind11::module_& module);   // torque_map
void bind_motion(pybind11::module_& module);     // propagate
void bind_platform(pybind11::module_& module);   // budget, balance
void bind_diagnosis(pybind11::module_& module);  // diagnose
void bind_tracking(pybind11::module_& module);   // camera, estimate

}  // namespace photorque::python
