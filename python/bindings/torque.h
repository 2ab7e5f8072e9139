// Torques written in Python: for trying a law out before it becomes a kind.
#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "attitude/model/disturbance.h"
#include "python/bindings/call.h"

namespace photorque::python {

// `function(time_s, attitude_wxyz, rate_body_rad_s)` gets arrays of shape (n,), (n, 4), (n, 3) and
// gives the torques about the centre of rotation in body axes, (n, 3) in N m: row by row the same
// law, and smooth. It is called with the interpreter's lock, which costs some ten microseconds for
// every eight instants; derivatives are taken by differences. What it raises ends the call.
Disturbance own_torque(const std::string& name, const py::object& function, const Call& call);

}  // namespace photorque::python
