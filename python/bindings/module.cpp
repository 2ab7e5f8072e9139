// The extension module photorque._photorque.
#include <pybind11/pybind11.h>

#include "core/errors.h"
#include "core/provenance.h"
#include "python/bindings/bind.h"
#include "python/bindings/experiment.h"
#include "python/bindings/lamp.h"
#include "python/bindings/results.h"

PYBIND11_MODULE(_photorque, module) {
  namespace py = pybind11;
  using namespace photorque;
  module.doc() =
      "Irradiance, solar-array power, radiation torque and attitude of free-floating platforms.";
  const Provenance build = build_provenance();
  module.attr("__version__") = build.version;
  module.attr("git_hash") = build.git_hash;
  py::register_exception<InputError>(module, "InputError", PyExc_ValueError).doc() =
      "Wrong input. The message is one line with file, line, key, the value found and the value "
      "expected.";
  py::register_exception<NumericalError>(module, "NumericalError", PyExc_ArithmeticError).doc() =
      "A computation failed, although the input is valid.";
  python::bind_experiment(module);
  python::bind_results(module);
  python::bind_lamp(module);
  python::bind_light(module);
  python::bind_wrenches(module);
  python::bind_motion(module);
  python::bind_platform(module);
  python::bind_diagnosis(module);
  python::bind_tracking(module);
}
