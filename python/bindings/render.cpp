// render(): a picture of the scene, as pixels.
#include "tools/verbs/render.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "python/bindings/bind.h"
#include "python/bindings/call.h"
#include "python/bindings/experiment.h"
#include "python/bindings/lamp.h"
#include "python/bindings/results.h"

namespace photorque::python {
namespace {

std::shared_ptr<RenderRun> render(const ExperimentHandle& experiment, int threads,
                                  const py::object& seed, std::optional<double> target_error,
                                  std::optional<double> max_time_s, const py::iterable& lamps,
                                  const py::object& progress, const py::object& log) {
  RunOptions options = experiment.with(threads, seed);
  options.target_error = target_error;
  options.max_time_s = max_time_s;
  const Call call(options.experiment, progress, log);
  add_lamps(options, lamps, call);
  return call.run([&] { return std::make_shared<RenderRun>(run_render(options, call.console())); });
}

py::array pixels_of(const py::object& self) {
  const Picture& picture = self.cast<const RenderRun&>().picture;
  const py::ssize_t width = picture.width;
  py::array array(py::dtype::of<uint8_t>(), {py::ssize_t{picture.height}, width, py::ssize_t{3}},
                  {3 * width, py::ssize_t{3}, py::ssize_t{1}}, picture.rgb.data(), self);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

}  // namespace

void bind_render(py::module_& module) {
  py::class_<RenderRun, std::shared_ptr<RenderRun>>(
      module, "Render", "A picture of the scene with the irradiance on its receivers.")
      .def_property_readonly("pixels", &pixels_of,
                             "Red, green, blue (rows from the top, columns, 3), 0 to 255, sRGB: "
                             "for matplotlib's imshow.")
      .def_property_readonly("title", [](const RenderRun& run) { return run.title; })
      .def_property_readonly("provenance",
                             [](const RenderRun& run) { return provenance_of(run.provenance); })
      .def(
          "write",
          [](const RenderRun& self, const std::filesystem::path& folder) {
            const py::gil_scoped_release release;
            return write_render(self, folder).string();
          },
          py::arg("folder"), "Writes render.png as the program does; gives its path.");
  module.def("render", &render, py::arg("experiment"), py::kw_only(), py::arg("threads") = 0,
             py::arg("seed") = py::none(), py::arg("target_error") = py::none(),
             py::arg("max_time_s") = py::none(), py::arg("lamps") = py::list(),
             py::arg("progress") = py::none(), py::arg("log") = py::none(),
             "Traces the experiment and looks at it from its [camera].");
}

}  // namespace photorque::python
