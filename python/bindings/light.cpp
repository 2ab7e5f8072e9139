// trace(), power(), render() and fit_cell(): irradiance, radiation force and torque, solar-array
// power, pictures, parameters of cells.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "python/bindings/arrays.h"
#include "python/bindings/bind.h"
#include "python/bindings/call.h"
#include "python/bindings/experiment.h"
#include "python/bindings/lamp.h"
#include "python/bindings/pages.h"
#include "python/bindings/results.h"
#include "tools/verbs/fit_cell.h"
#include "tools/verbs/power.h"
#include "tools/verbs/render.h"
#include "tools/verbs/trace.h"

namespace photorque::python {
namespace {

using FluxMaps = std::vector<std::pair<std::string, FluxMap>>;

struct LightHandle {
  std::shared_ptr<const OpticalRun> run;
  OpticalResult light;
  RunResult result;
  PageHead head;
  FluxMaps flux_maps = {};
  WrenchEstimate wrench = {};  // on the whole scene about the centre of rotation, body frame

  void evaluate() {
    for (size_t i = 0; i < run->experiment().receivers.size(); ++i) {
      const NamedReceiver& receiver = run->experiment().receivers[i];
      if (!receiver.flux_map) continue;
      flux_maps.emplace_back(receiver.name, receiver.flux_map->flux_map(light.sums[i]));
    }
    wrench = run->wrench_of(light);
  }
};

struct PowerHandle : LightHandle {
  ArrayResult power = {};
};

// Result of a trace or of a power run as a Python object.
template <class Handle, class Run>
Handle handle_of(Run& run, const RunOptions& options, const char* verb) {
  Handle handle;
  handle.run = std::move(run.run);
  handle.light = std::move(run.light);
  handle.result = std::move(run.result);
  handle.head = head_of(options, verb);
  handle.evaluate();
  return handle;
}

LightHandle trace(const RunOptions& options, const Console& console) {
  TraceRun run = run_trace(options, console);
  return handle_of<LightHandle>(run, options, "trace");
}

PowerHandle power(const RunOptions& options, const Console& console) {
  PowerRun run = run_power(options, console);
  PowerHandle handle = handle_of<PowerHandle>(run, options, "power");
  handle.power = std::move(run.power);
  return handle;
}

py::array layer_view(const py::object& self, FluxLayer FluxMap::*layer, double Estimate::*number) {
  const auto& map = self.cast<const FluxMap&>();
  return view((map.*layer).per_bin_W_m2, number, static_cast<size_t>(map.grid.height),
              static_cast<size_t>(map.grid.width), self);
}

void bind_flux_map(py::module_& module) {
  const auto layer = [](FluxLayer FluxMap::*of, double Estimate::*number) {
    return [of, number](const py::object& self) { return layer_view(self, of, number); };
  };
  py::class_<FluxMap>(
      module, "FluxMap",
      "Irradiance of each bin of a surface: arrays of shape (bins along v, bins along "
      "u), both rising; NaN where there is no surface.")
      .def_property_readonly("irradiance_W_m2", layer(&FluxMap::incident, &Estimate::value),
                             "Mean incident irradiance of each bin [W/m²].")
      .def_property_readonly("irradiance_standard_error_W_m2",
                             layer(&FluxMap::incident, &Estimate::standard_error),
                             "Standard error of irradiance_W_m2 [W/m²].")
      .def_property_readonly("absorbed_W_m2", layer(&FluxMap::absorbed, &Estimate::value),
                             "Mean absorbed power per area of each bin [W/m²].")
      .def_property_readonly("absorbed_standard_error_W_m2",
                             layer(&FluxMap::absorbed, &Estimate::standard_error),
                             "Standard error of absorbed_W_m2 [W/m²].")
      .def_property_readonly(
          "power_W", [](const FluxMap& map) { return map.incident.power_W; },
          "Incident power on the surface [W], an Estimate.")
      .def_property_readonly(
          "absorbed_power_W", [](const FluxMap& map) { return map.absorbed.power_W; },
          "Absorbed power of the surface [W], an Estimate.")
      .def_property_readonly(
          "area_m2",
          [](const py::object& self) {
            const SurfaceGrid& grid = self.cast<const FluxMap&>().grid;
            return view(grid.area_m2, static_cast<size_t>(grid.height),
                        static_cast<size_t>(grid.width), self);
          },
          "Area of the surface in every bin [m²].")
      .def_property_readonly(
          "extent",
          [](const FluxMap& map) {
            return py::make_tuple(map.grid.u_low, map.grid.u_high, map.grid.v_low, map.grid.v_high);
          },
          "Outer edges (u, u, v, v), in metres or in texture coordinates.");
}

py::dict flux_maps_of(const py::object& self) {
  py::dict maps;
  for (const auto& [name, map] : self.cast<const LightHandle&>().flux_maps) {
    maps[py::str(name)] = py::cast(map, py::return_value_policy::reference_internal, self);
  }
  return maps;
}

py::object cells_view(const py::object& self, const std::vector<double>& cells) {
  const ArrayResult& power = self.cast<const PowerHandle&>().power;
  return view(cells, static_cast<size_t>(power.rows), static_cast<size_t>(power.columns), self);
}

void bind_runs(py::module_& module) {
  auto trace = py::class_<LightHandle>(module, "Trace",
                                       "Power balance, irradiance, force and torque of a trace.");
  add_result(trace, "trace");
  trace
      .def_property_readonly("flux_maps", &flux_maps_of,
                             "The FluxMap of every receiver of kind flux_map, by name.")
      .def_property_readonly(
          "force_body_N", [](const LightHandle& self) { return copy_of(self.wrench.mean.force_N); },
          "Radiation force, body axes [N], shape (3,); a copy.")
      .def_property_readonly(
          "force_standard_error_N",
          [](const LightHandle& self) { return copy_of(self.wrench.force_error_N()); },
          "Standard error of force_body_N [N], shape (3,); a copy.")
      .def_property_readonly(
          "torque_body_N_m",
          [](const LightHandle& self) { return copy_of(self.wrench.mean.torque_N_m); },
          "Torque about the centre of rotation, body axes [N m].")
      .def_property_readonly(
          "torque_standard_error_N_m",
          [](const LightHandle& self) { return copy_of(self.wrench.torque_error_N_m()); },
          "Standard error of torque_body_N_m [N m], shape (3,); a copy.")
      .def_property_readonly(
          "rays", [](const LightHandle& self) { return self.light.rays; }, "Number of traced rays.")
      .def(
          "write_page",
          [](const LightHandle& self, const std::filesystem::path& path) {
            return write_alone(
                path, [&] { return light_page(*self.run, self.light, self.result, self.head); });
          },
          py::arg("path"), "Writes the run as one HTML page; returns its path.");
  auto power = py::class_<PowerHandle, LightHandle>(module, "Power",
                                                    "A trace and the power of the solar array.");
  add_result(power, "power");
  power
      .def_property_readonly("curve", table_view<PowerHandle>("iv"),
                             "Table voltage_V, current_A, power_W from short to open circuit.")
      .def_property_readonly("maxima", table_view<PowerHandle>("maxima"),
                             "Table of all local maxima of the power, by rising voltage.")
      .def_property_readonly(
          "power_W", [](const PowerHandle& self) { return self.power.power_W; },
          "Electric power at the maximum power point [W], an Estimate.")
      .def_property_readonly(
          "voltage_V", [](const PowerHandle& self) { return self.power.voltage_V; },
          "Voltage of the array at the maximum power point [V], an Estimate.")
      .def_property_readonly(
          "current_A", [](const PowerHandle& self) { return self.power.current_A; },
          "Current of the array at the maximum power point [A], an Estimate.")
      .def_property_readonly(
          "cell_light_W",
          [](const py::object& self) {
            return cells_view(self, self.cast<const PowerHandle&>().power.cell_light_W);
          },
          "Light on each cell [W], shape (rows, columns).")
      .def_property_readonly(
          "cell_voltage_V",
          [](const py::object& self) {
            return cells_view(self, self.cast<const PowerHandle&>().power.cells.voltages_V);
          },
          "Voltage of each cell at the maximum power point [V], shape (rows, columns).");
}

py::array pixels_of(const py::object& self) {
  const Picture& picture = self.cast<const RenderRun&>().picture;
  const py::ssize_t width = picture.width;
  py::array array(py::dtype::of<uint8_t>(), {py::ssize_t{picture.height}, width, py::ssize_t{3}},
                  {3 * width, py::ssize_t{3}, py::ssize_t{1}}, picture.rgb.data(), self);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

void bind_render(py::module_& module) {
  py::class_<RenderRun>(module, "Render",
                        "A picture of the scene with the irradiance on its receivers.")
      .def_property_readonly("pixels", &pixels_of,
                             "Red, green, blue (rows from the top, columns, 3), 0 to 255, sRGB: "
                             "for matplotlib's imshow.")
      .def_property_readonly(
          "title", [](const RenderRun& run) { return run.title; }, "Title of the picture.")
      .def_property_readonly(
          "provenance", [](const RenderRun& run) { return provenance_of(run.provenance); },
          "Version, git hash, seed and the hashes of all inputs.")
      .def(
          "write",
          [](const RenderRun& self, const std::filesystem::path& folder) {
            const py::gil_scoped_release release;
            return write_render(self, folder).string();
          },
          py::arg("folder"), "Writes render.png and returns its path.");
  def_traced(module, "render", &run_render,
             "Traces the experiment and returns a picture of the scene, seen from [camera].");
}

struct CellFit {
  RunResult result;
};

CellFit fit_cell(const ExperimentHandle& experiment, const py::object& log) {
  const Call call(experiment.options.experiment, py::none(), log);
  return call.run([&] { return CellFit{run_fit_cell(experiment.options, call.console())}; });
}

void bind_cell_fit(py::module_& module) {
  auto type = py::class_<CellFit>(module, "CellFit",
                                  "Fitted parameters of a cell, with standard errors, as figures.");
  add_result(type, "fit-cell");
  module.def("fit_cell", &fit_cell, py::arg("experiment"), py::kw_only(),
             py::arg("log") = py::none(),
             "Solar cell parameters from the current-voltage sweeps or datasheet of [fit].");
}

}  // namespace

void bind_light(py::module_& module) {
  bind_flux_map(module);
  bind_runs(module);
  bind_render(module);
  bind_cell_fit(module);
  def_traced(module, "trace", &trace,
             "Irradiance on every receiver, power balance, radiation force and torque.");
  def_traced(module, "power", &power,
             "Trace, then the solar array: current-voltage curve and maximum power point.");
}

}  // namespace photorque::python
