// HTML pages and glTF scenes of runs, from Python.
#pragma once

#include <pybind11/pybind11.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "tools/pages/pages.h"
#include "tools/runs/options.h"

namespace photorque::python {

namespace py = pybind11;

// Head of the page of the command `verb`.
inline PageHead head_of(const RunOptions& options, const std::string& verb) {
  const std::string name = options.experiment.filename().string();
  std::string function = verb;
  std::ranges::replace(function, '-', '_');
  return {options.experiment.stem().string(), verb, "photorque." + function + "(\"" + name + "\")"};
}

// Writes one file of a run to a path given by the caller; `file` makes it, without the
// interpreter's lock.
template <class MakeFile>
std::string write_alone(const std::filesystem::path& path, const MakeFile& file) {
  const py::gil_scoped_release release;
  file().write(path);
  return path.string();
}

}  // namespace photorque::python
