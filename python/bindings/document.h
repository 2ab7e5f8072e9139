// Python's values as settings and back: dict, list, tuple, str, bool, int, float, and NumPy's.
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <string>

#include "core/settings/settings.h"

namespace photorque::python {

namespace py = pybind11;

// `key` is how an error calls the value. InputError for what no experiment can hold.
SettingsNode settings_of(const py::handle& value, const std::string& key);

py::object value_of(const SettingsNode& node);

}  // namespace photorque::python
