// Torques written in Python, for experiments before a new kind is implemented.
#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "attitude/model/disturbance.h"
#include "python/bindings/call.h"

namespace photorque::python {

// `function(time_s, attitude_wxyz, rate_body_rad_s)` receives arrays of shape (n,), (n, 4), (n, 3).
// It returns the torques about the centre of rotation in body axes [N m], shape (n, 3). Each row
// must depend only on its own instant, and smoothly. The function is called with the interpreter's
// lock, which costs about ten microseconds per eight instants; derivatives are computed by
// differences. An exception in it ends the call.
Disturbance own_torque(const std::string& name, const py::object& function, const Call& call);

}  // namespace photorque::python
