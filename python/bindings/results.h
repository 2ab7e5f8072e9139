// Results of every run: figures with errors, tables, maps, provenance, files.
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <string>

#include "tools/runs/result.h"

namespace photorque::python {

namespace py = pybind11;

// The Python classes Estimate, Table, Map, Plot, Panel and Curve.
void bind_results(py::module_& module);

// The quantities of a result as Estimates, by name.
py::dict figures_of(const RunResult& result);
// Views by name; they keep `owner` alive.
template <class Item>
py::dict views_of(const std::vector<Item>& items, const py::object& owner) {
  py::dict views;
  for (const Item& item : items) {
    views[py::str(item.name)] = py::cast(item, py::return_value_policy::reference_internal, owner);
  }
  return views;
}
py::dict provenance_of(const Provenance& provenance);
// Text of a result: the command and its first figures, such as "<power: emitted_W = 88,
// absorbed_W = 76.8592 ± 0.0014, …>".
std::string text_of(const RunResult& result, const std::string& command);
// Writes the files that the program writes for this command; returns their paths.
py::list write_of(const RunResult& result, const std::filesystem::path& folder,
                  const std::string& command, const std::vector<std::string>& formats);
// Property of a run that has a member `result`: a view of the table of this name. Throws
// NumericalError if it is missing.
template <class Run>
auto table_view(const char* name) {
  return [name](const py::object& self) {
    return py::cast(table_named(self.cast<const Run&>().result.product, name),
                    py::return_value_policy::reference_internal, self);
  };
}

// Adds the common properties of all runs to the class of a run, which has a member `result`.
// `command` is the equivalent command of the program.
template <class Run, class... More>
void add_result(py::class_<Run, More...>& type, const std::string& command) {
  const auto result_of = [](const py::object& self) -> const RunResult& {
    return self.cast<const Run&>().result;
  };
  const auto views = [result_of](auto Product::*items) {
    return [result_of, items](const py::object& self) {
      return views_of(result_of(self).product.*items, self);
    };
  };
  type.def_property_readonly(
          "figures", [result_of](const py::object& self) { return figures_of(result_of(self)); },
          "Headline figures with their standard errors, by name; the unit is the name's end.")
      .def_property_readonly("tables", views(&Product::tables), "Tables by name.")
      .def_property_readonly("maps", views(&Product::maps), "Maps by name.")
      .def_property_readonly("plots", views(&Product::plots), "Curves by name.")
      .def(
          "plot",
          [](const py::object& self, const py::object& name, const py::object& axes) {
            return py::module_::import("photorque.plots").attr("draw_result")(self, name, axes);
          },
          py::arg("name") = py::none(), py::arg("axes") = py::none(),
          "Draws the map or plot of this name with matplotlib and gives its Axes; all without a "
          "name.")
      .def_property_readonly(
          "warnings",
          [result_of](const py::object& self) {
            py::list lines;
            for (const std::string& line : result_of(self).provenance.warnings) lines.append(line);
            return lines;
          },
          "One line for each check of the run that failed.")
      .def_property_readonly(
          "provenance",
          [result_of](const py::object& self) { return provenance_of(result_of(self).provenance); },
          "Version, git hash, seed and the hashes of all inputs.")
      .def_property_readonly(
          "summary_json", [result_of](const py::object& self) { return result_of(self).summary(); },
          "The content of summary.json.")
      .def("__repr__", [result_of, command](
                           const py::object& self) { return text_of(result_of(self), command); })
      .def(
          "write",
          [result_of, command](const py::object& self, const std::filesystem::path& folder,
                               const std::vector<std::string>& formats) {
            return write_of(result_of(self), folder, command, formats);
          },
          py::arg("folder"), py::arg("formats") = std::vector<std::string>{},
          "Writes every file that the program writes, and further formats as by --format; gives "
          "their paths.");
}

}  // namespace photorque::python
