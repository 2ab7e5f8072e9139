// render(): a picture of the scene as pixels.
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
          py::arg("folder"), "Writes render.png as the program does; gives its path.");
  def_traced(module, "render", &run_render,
             "Traces the experiment and returns a picture of the scene, seen from [camera].");
}

}  // namespace photorque::python
