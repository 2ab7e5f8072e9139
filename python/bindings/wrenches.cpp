// torque_map(): wrench of light over attitudes or over directions of light.
#include "python/bindings/arrays.h"
#include "python/bindings/bind.h"
#include "python/bindings/call.h"
#include "python/bindings/experiment.h"
#include "python/bindings/lamp.h"
#include "python/bindings/pages.h"
#include "python/bindings/results.h"
#include "tools/pages/pages.h"
#include "tools/verbs/torque_map.h"

namespace photorque::python {
namespace {

struct TorqueMapHandle : TorqueMapRun {
  std::optional<RunFile> page = {};
};

TorqueMapHandle torque_map(const ExperimentHandle& experiment, int threads, const py::object& seed,
                           const py::iterable& lamps, bool page, const py::object& progress,
                           const py::object& log) {
  RunOptions options = experiment.with(threads, seed);
  const Call call(options.experiment, progress, log);
  add_lamps(options, lamps, call);
  return call.run([&] {
    SceneStage stage;
    TorqueMapHandle handle{
        run_torque_map(options, call.console(), page ? add_to(stage) : NodeWatch())};
    if (page) {
      handle.page = torque_map_page(*handle.run, handle.wrenches, handle.result, std::move(stage),
                                    head_of(options, "torque-map"));
    }
    return handle;
  });
}

std::string write_page(const TorqueMapHandle& self, const std::filesystem::path& path) {
  if (!self.page) {
    throw InputError({}, "write_page", "a run that kept no light for a page",
                     "torque_map(experiment, page=True)");
  }
  return write_alone(path, [&] { return *self.page; });
}

auto node_view(std::vector<Vec3> WrenchTable::*vectors) {
  return [vectors](const py::object& self) {
    const WrenchTable& table = self.cast<const TorqueMapHandle&>().wrenches;
    return view(table.*vectors,
                {static_cast<py::ssize_t>(table.around_rad.size()),
                 static_cast<py::ssize_t>(table.polar_rad.size())},
                self);
  };
}

py::tuple wrench_between(const TorqueMapHandle& run, double polar_rad, double around_rad) {
  const Wrench wrench = wrench_at(run.wrenches, {polar_rad, around_rad});
  return py::make_tuple(copy_of(wrench.force_N), copy_of(wrench.torque_N_m));
}

}  // namespace

void bind_wrenches(py::module_& module) {
  auto type = py::class_<TorqueMapHandle>(
      module, "TorqueMap",
      "Force and torque of light on the body over two angles, body frame: arrays of shape (around, "
      "polar, 3).");
  add_result(type, "torque-map");
  type.def_property_readonly(
          "angles",
          [](const TorqueMapHandle& run) {
            const bool tilts = run.wrenches.angles == WrenchTable::Angles::tilt_heading;
            return tilts ? "tilt_heading" : "azimuth_elevation";
          },
          "\"tilt_heading\": polar is the tilt, around the heading; \"azimuth_elevation\" of the "
          "direction towards the light: polar is the elevation, around the azimuth.")
      .def_property_readonly(
          "polar_rad",
          [](const py::object& self) {
            return view(self.cast<const TorqueMapHandle&>().wrenches.polar_rad, self);
          },
          "Polar angles of the nodes [rad]: tilt or elevation; see angles.")
      .def_property_readonly(
          "around_rad",
          [](const py::object& self) {
            return view(self.cast<const TorqueMapHandle&>().wrenches.around_rad, self);
          },
          "Azimuthal angles of the nodes [rad]: heading or azimuth; see angles.")
      .def_property_readonly("force_body_N", node_view(&WrenchTable::force_body_N),
                             "Force at each node, body axes [N], shape (around, polar, 3).")
      .def_property_readonly("force_standard_error_N", node_view(&WrenchTable::force_error_N),
                             "Standard error of force_body_N [N].")
      .def_property_readonly("torque_body_N_m", node_view(&WrenchTable::torque_body_N_m),
                             "Torque about the centre of rotation at each node, body axes [N m], "
                             "shape (around, polar, 3).")
      .def_property_readonly("torque_standard_error_N_m", node_view(&WrenchTable::torque_error_N_m),
                             "Standard error of torque_body_N_m [N m].")
      .def("at", &wrench_between, py::arg("polar_rad"), py::arg("around_rad"),
           "(force [N], torque [N m]) by bilinear interpolation, body axes. Raises NumericalError "
           "outside the grid.")
      .def("write_page", &write_page, py::arg("path"),
           "Writes one HTML page with sliders over the attitudes; returns its path. Requires "
           "page=True.");
  module.def("torque_map", &torque_map, py::arg("experiment"), py::kw_only(),
             py::arg("threads") = 0, py::arg("seed") = py::none(), py::arg("lamps") = py::list(),
             py::arg("page") = false, py::arg("progress") = py::none(), py::arg("log") = py::none(),
             "Force, torque and power over the attitudes or directions of [torque_map].\n\n"
             "`page`: keeps the light of every attitude for write_page().");
}

}  // namespace photorque::python
