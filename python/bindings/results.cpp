#include "python/bindings/results.h"

#include <algorithm>

#include "core/text/parse.h"
#include "images/drawing/plot.h"
#include "python/bindings/arrays.h"
#include "tools/runs/console.h"

namespace photorque::python {
namespace {

py::object column_view(const Table::Column& column, const py::object& owner) {
  if (column.texts.empty()) return view(column.values, owner);
  py::list texts;
  for (const std::string& text : column.texts) texts.append(text);
  return texts;
}

py::dict columns_of(const py::object& self) {
  py::dict columns;
  for (const Table::Column& column : self.cast<const Table&>().columns) {
    columns[py::str(column.name)] = column_view(column, self);
  }
  return columns;
}

py::object column_called(const py::object& self, const std::string& name) {
  std::string names;
  for (const Table::Column& column : self.cast<const Table&>().columns) {
    if (column.name == name) return column_view(column, self);
    names += (names.empty() ? "" : ", ") + column.name;
  }
  throw py::key_error("no column '" + name + "', expected one of " + names);
}

void bind_table(py::module_& module) {
  py::class_<Table>(module, "Table",
                    "Columns of equal length, by name; each name ends with the unit.")
      .def_readonly("name", &Table::name, "Name of the table; that of its file without extension.")
      .def_readonly("title", &Table::title, "Title of the table.")
      .def("keys", [](const py::object& self) { return py::list(columns_of(self)); })
      .def("to_dict", &columns_of, "All columns as a dict of arrays.")
      .def("__getitem__", &column_called, py::arg("column"))
      .def("__contains__",
           [](const py::object& self, const std::string& name) {
             return columns_of(self).contains(name.c_str());
           })
      .def("__len__",
           [](const Table& table) {
             return table.columns.empty() ? 0 : table.columns.front().size();
           })
      .def(
          "to_pandas",
          [](const py::object& self) {
            return py::module_::import("pandas").attr("DataFrame")(columns_of(self));
          },
          "The table as a pandas DataFrame.")
      .def("__repr__", [](const Table& table) {
        return "Table(\"" + table.name + "\", " + std::to_string(table.columns.size()) +
               " columns)";
      });
}

py::array map_view(const py::object& self, std::vector<double> Map::*numbers) {
  const auto& map = self.cast<const Map&>();
  return view(map.*numbers, static_cast<size_t>(map.height), static_cast<size_t>(map.width), self);
}

void bind_map(py::module_& module) {
  py::class_<Map>(module, "Map", "A field over a regular grid: averages over its bins.")
      .def_readonly("name", &Map::name, "Name of the map; that of its files without extension.")
      .def_readonly("title", &Map::title, "Title of the picture.")
      .def_readonly("unit", &Map::unit, "Unit of the values.")
      .def_readonly("x_label", &Map::x_label, "Label of the x axis with its unit.")
      .def_readonly("y_label", &Map::y_label, "Label of the y axis with its unit.")
      .def_property_readonly(
          "value", [](const py::object& self) { return map_view(self, &Map::value); },
          "Values of shape (rows, columns): rows along increasing y, columns along increasing x.")
      .def_property_readonly(
          "standard_error",
          [](const py::object& self) -> py::object {
            if (self.cast<const Map&>().standard_error.empty()) return py::none();
            return map_view(self, &Map::standard_error);
          },
          "Standard error of every value; None if the values are exact.")
      .def_property_readonly(
          "extent",
          [](const Map& map) {
            return py::make_tuple(map.x_low, map.x_high, map.y_low, map.y_high);
          },
          "Outer edges (x, x, y, y), for matplotlib's imshow with origin=\"lower\".")
      .def_readonly("is_signed", &Map::signed_values,
                    "True if values may be negative; the colour scale is then centred on zero.")
      .def_readonly("has_equal_scale", &Map::equal_scale,
                    "True if x and y have the same unit of length.")
      .def(
          "plot",
          [](const py::object& self, const py::object& axes) {
            return py::module_::import("photorque.plots").attr("draw_map")(self, axes);
          },
          py::arg("axes") = py::none(), "Draws with matplotlib; returns the Axes.")
      .def(
          "to_xarray",
          [](const py::object& self) {
            return py::module_::import("photorque.plots").attr("map_to_xarray")(self);
          },
          "The map as an xarray.Dataset: value and standard_error at the centres of the bins.");
}

const char* style_of(const Plot::Curve& curve) {
  if (curve.bars) return "bars";
  if (curve.markers) return "points";
  if (curve.dots) return "dots";
  return curve.dashed ? "dashed" : "line";
}

void bind_plot(py::module_& module) {
  using Curve = Plot::Curve;
  using Panel = Plot::Panel;
  py::class_<Curve>(module, "Curve", "One curve of a plot.")
      .def_readonly("label", &Curve::label, "Name of the curve in the legend.")
      .def_property_readonly("style", &style_of,
                             "\"line\", \"dashed\", \"points\", \"dots\" or \"bars\".")
      .def_property_readonly(
          "x", [](const py::object& self) { return view(self.cast<const Curve&>().x, self); },
          "Values of x.")
      .def_property_readonly(
          "y", [](const py::object& self) { return view(self.cast<const Curve&>().y, self); },
          "Values of y; NaN: a gap.")
      .def_property_readonly(
          "y_error",
          [](const py::object& self) -> py::object {
            const auto& curve = self.cast<const Curve&>();
            if (curve.y_error.empty()) return py::none();
            return view(curve.y_error, self);
          },
          "Standard error of every y; None if the values are exact.");
  py::class_<Panel>(module, "Panel", "One pair of axes of a plot.")
      .def_readonly("y_label", &Panel::y_label, "Label of the y axis with its unit.")
      .def_readonly("y_log", &Panel::y_log, "True if the y axis is logarithmic.")
      .def_readonly("curves", &Panel::curves, "List of Curve.")
      .def_readonly("levels", &Panel::levels,
                    "Values of y at which dotted horizontal lines are drawn.");
  py::class_<Plot>(module, "Plot", "Curves in axes that share x.")
      .def_readonly("name", &Plot::name, "Name of the plot; that of its files without extension.")
      .def_readonly("title", &Plot::title, "Title of the plot.")
      .def_readonly("x_label", &Plot::x_label, "Label of the x axis with its unit.")
      .def_readonly("x_log", &Plot::x_log, "True if the x axis is logarithmic.")
      .def_property_readonly("panels", &panels_of, "The axes, from top to bottom.")
      .def(
          "plot",
          [](const py::object& self, const py::object& axes) {
            return py::module_::import("photorque.plots").attr("draw_plot")(self, axes);
          },
          py::arg("axes") = py::none(), "Draws with matplotlib; returns the Axes.");
}

}  // namespace

void bind_results(py::module_& module) {
  py::class_<Estimate>(module, "Estimate", "A number and its standard error (0: exact).")
      .def_readonly("value", &Estimate::value, "The number.")
      .def_readonly("standard_error", &Estimate::standard_error,
                    "Its standard error; 0 if it is exact, infinite if it is undetermined.")
      .def("__float__", [](const Estimate& estimate) { return estimate.value; })
      .def("__repr__", [](const Estimate& estimate) {
        return "Estimate(" + std::string(trimmed(show(estimate, ""))) + ")";
      });
  bind_table(module);
  bind_map(module);
  bind_plot(module);
}

std::string text_of(const RunResult& result, const std::string& command) {
  constexpr size_t most = 4;
  std::string text = "<" + command + ":";
  const std::vector<Quantity>& figures = result.product.quantities;
  for (size_t i = 0; i < std::min(most, figures.size()); ++i) {
    text += (i == 0 ? " " : ", ") + figures[i].name + " = " +
            std::string(trimmed(show(figures[i].estimate, "")));
  }
  return text + (figures.size() > most ? ", …>" : ">");
}

py::dict figures_of(const RunResult& result) {
  py::dict figures;
  for (const Quantity& figure : result.product.quantities) {
    figures[py::str(figure.name)] = py::cast(figure.estimate);
  }
  return figures;
}

py::dict provenance_of(const Provenance& provenance) {
  py::dict all;
  all["program"] = provenance.program;
  all["version"] = provenance.version;
  all["git_hash"] = provenance.git_hash;
  all["seed"] = provenance.seed;
  py::dict inputs;
  for (const auto& [name, hash] : provenance.inputs) inputs[py::str(name)] = hash;
  all["inputs"] = inputs;
  return all;
}

py::list write_of(const RunResult& result, const std::filesystem::path& folder,
                  const std::string& command, const std::vector<std::string>& formats) {
  std::vector<std::filesystem::path> paths;
  {
    const py::gil_scoped_release release;
    paths = write_run(result, folder, command, {.further = formats});
  }
  paths.push_back(folder / "summary.json");
  for (const RunFile& file : result.files) paths.push_back(folder / file.name);
  py::list texts;
  for (const auto& path : paths) texts.append(path.string());
  return texts;
}

}  // namespace photorque::python
