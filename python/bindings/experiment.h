// The Python class Experiment.
#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "tools/runs/options.h"

namespace photorque::python {

namespace py = pybind11;

// The nominal model of a laboratory: the text of an experiment, with overrides of its keys.
struct ExperimentHandle {
  RunOptions options;  // includes the text

  // Options of a run with this number of threads (0: all) and, unless None, with another seed.
  RunOptions with(int threads, const py::object& seed) const;
};

// A name or text as UTF-8. InputError with the key if the value is something else.
std::string text_of(const py::handle& text, const std::string& key, const std::string& expected);

// The class Experiment, and check(), which validates one without a run.
void bind_experiment(py::module_& module);

}  // namespace photorque::python
