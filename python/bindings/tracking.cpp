// camera() and estimate(): errors of the attitude measurement, and attitude estimation from
// readings.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "python/bindings/bind.h"
#include "python/bindings/call.h"
#include "python/bindings/experiment.h"
#include "python/bindings/results.h"
#include "tools/verbs/attitude/camera.h"
#include "tools/verbs/attitude/estimate.h"

namespace photorque::python {
namespace {

CameraRun study_camera(const ExperimentHandle& experiment, int threads, const py::object& progress,
                       const py::object& log) {
  const RunOptions options = experiment.with(threads, py::none());
  const Call call(options.experiment, progress, log);
  return call.run([&] { return run_camera(options, call.console()); });
}

EstimateRun estimate_attitude(const ExperimentHandle& experiment,
                              const std::vector<std::filesystem::path>& recordings,
                              const std::optional<std::filesystem::path>& truth, int threads,
                              const py::object& seed, const py::object& progress,
                              const py::object& log) {
  const RunOptions options = experiment.with(threads, seed);
  const Call call(options.experiment, progress, log);
  return call.run([&] { return run_estimate(options, call.console(), recordings, truth); });
}

py::array_t<double> matrix_of(const std::vector<AttitudeEstimate>& estimates, py::ssize_t columns,
                              const std::function<double(const AttitudeEstimate&, int)>& entry) {
  py::array_t<double> array({static_cast<py::ssize_t>(estimates.size()), columns});
  auto numbers = array.mutable_unchecked<2>();
  for (py::ssize_t i = 0; i < numbers.shape(0); ++i) {
    for (int k = 0; k < columns; ++k) numbers(i, k) = entry(estimates[static_cast<size_t>(i)], k);
  }
  return array;
}

py::dict series_of(const std::vector<AttitudeEstimate>& estimates) {
  using One = AttitudeEstimate;
  py::dict series;
  series["t_s"] =
      matrix_of(estimates, 1, [](const One& e, int) { return e.time_s; }).attr("ravel")();
  series["attitude_wxyz"] = matrix_of(estimates, 4, [](const One& e, int k) {
    return k == 0 ? e.lab_from_body.w() : e.lab_from_body.vec()[k - 1];
  });
  series["attitude_sigma_rad"] =
      matrix_of(estimates, 3, [](const One& e, int k) { return std::sqrt(e.covariance(k, k)); });
  series["rate_body_rad_s"] =
      matrix_of(estimates, 3, [](const One& e, int k) { return e.rate_body_rad_s[k]; });
  series["rate_sigma_rad_s"] = matrix_of(
      estimates, 3, [](const One& e, int k) { return std::sqrt(e.covariance(3 + k, 3 + k)); });
  return series;
}

const Estimation& chosen_of(const EstimateRun& run, size_t recording) {
  if (recording >= run.estimated.size()) throw py::index_error("no recording of this number");
  const EstimateResult& result = run.estimated[recording].result;
  return result.methods[result.chosen].estimation;
}

}  // namespace

void bind_tracking(py::module_& module) {
  auto camera = py::class_<CameraRun>(
      module, "Camera", "Attitude error of a camera that tracks markers: tables and maps.");
  add_result(camera, "camera");
  camera.def_readonly(
      "images_per_s", &CameraRun::images_per_s,
      "Simulated images per second on one thread, including the estimate of the pose.");
  module.def("camera", &study_camera, py::arg("experiment"), py::kw_only(), py::arg("threads") = 0,
             py::arg("progress") = py::none(), py::arg("log") = py::none(),
             "Attitude error of the camera in [sensors.camera] over tilt, lens and board, and the "
             "errors of "
             "simulated images compared with it.");

  auto estimate = py::class_<EstimateRun>(
      module, "AttitudeEstimate", "Attitude and rate by filter and smoother, of each recording.");
  add_result(estimate, "estimate");
  estimate
      .def(
          "smoothed",
          [](const EstimateRun& run, size_t recording) {
            return series_of(chosen_of(run, recording).smoothed);
          },
          py::arg("recording") = 0,
          "Attitude and rate from all readings (smoother): t_s (n,), attitude_wxyz (n, 4), "
          "rate_body_rad_s (n, 3), and their "
          "standard "
          "deviations about body axes, attitude_sigma_rad and rate_sigma_rad_s (n, 3); copies.")
      .def(
          "filtered",
          [](const EstimateRun& run, size_t recording) {
            return series_of(chosen_of(run, recording).filtered);
          },
          py::arg("recording") = 0,
          "Attitude and rate from the readings up to each time (filter); keys as in smoothed().")
      .def_property_readonly(
          "unseen",
          [](const EstimateRun& run) {
            py::list lines;
            for (const auto& one : run.estimated) {
              for (const std::string& line : one.result.unseen) lines.append(line);
            }
            return lines;
          },
          "Quantities that the readings do not determine, one line each.");
  module.def(
      "estimate", &estimate_attitude, py::arg("experiment"),
      py::arg("recordings") = std::vector<std::filesystem::path>(), py::kw_only(),
      py::arg("truth") = py::none(), py::arg("threads") = 0, py::arg("seed") = py::none(),
      py::arg("progress") = py::none(), py::arg("log") = py::none(),
      "Attitude and rate by Kalman filter and smoother of recordings or, without any, of simulated "
      "runs. `truth`: CSV file with the true motion of a single recording, for comparison.");
}

}  // namespace photorque::python
