// photorque camera: attitude error of the tracking camera, from its geometry.
#include "tools/verbs/attitude/camera.h"

#include <cmath>

#include "attitude/propagation/run.h"
#include "core/errors.h"
#include "tools/runs/attitude_run.h"
#include "tools/verbs/verb.h"

namespace photorque {
namespace {

// Number of poses per second that are computed from images: exposure, reading and solution.
double pace_1_s(const CameraStudy& study) {
  constexpr int images = 200;
  const WallTime wall;
  for (int i = 0; i < images; ++i) {
    take_image(study.camera, {}, {}, study.seed, static_cast<uint64_t>(i));
  }
  return images / wall.elapsed_s();
}

}  // namespace

CameraRun run_camera(const RunOptions& options, const Console& console) {
  const WallTime wall;
  const AttitudeExperiment experiment(options);
  NominalModel nominal = read_attitude_model(experiment.settings());
  if (!nominal.sensors.camera || !nominal.sensors.camera->geometry) {
    throw InputError({options.experiment.string()}, "sensors.camera.markers_m", "nothing",
                     "the positions of the markers, and lens and sensor of the camera");
  }
  const auto inputs = look_through_scene(experiment.file(), nominal.sensors);
  CameraRun run;
  run.study = read_camera_study(experiment.settings(), *nominal.sensors.camera->geometry,
                                nominal.model.platform.tilt_limit_rad);
  if (options.seed) run.study.seed = *options.seed;
  run.study.threads = options.threads;
  run.result.product = camera_product(run.study, console.progress("exposing"));
  console.done();
  run.result.provenance = experiment.provenance(run.study.seed);
  run.result.provenance.inputs.insert(run.result.provenance.inputs.end(), inputs.begin(),
                                      inputs.end());
  run.images_per_s = pace_1_s(run.study);
  run.result.cost = {wall.elapsed_s(), {}};
  return run;
}

}  // namespace photorque

namespace photorque::verbs::camera {
namespace {

void print_camera(const Console& console, const CameraRun& run) {
  const TrackingCamera& camera = run.study.camera;
  const Product& product = run.result.product;
  console.line(std::to_string(camera.markers.size()) + " markers, " +
               show(camera.focal_length_m * 1e3) + " mm f/" + show(camera.f_number) + ", " +
               std::to_string(camera.width) + " x " + std::to_string(camera.height) +
               " pixels of " + show(camera.pixel_m * 1e6) + " um, exposure " +
               show(camera.exposure_s * 1e6) + " us, spots " + show_brief(spot_sigma_px(camera)) +
               " px; pose " + (camera.knows_centre ? "about the centre of the bearing" : "free"));
  console.heading("Markers in the image at zero tilt");
  print_table(console, table_named(product, "markers"),
              {{"x [m]", "x_m"},
               {"y [m]", "y_m"},
               {"z [m]", "z_m"},
               {"column", "column_px"},
               {"row", "row_px"},
               {"electrons", "electrons"},
               {"brightest pixel", "brightest_pixel_electrons"},
               {"error [px]", "centre_error_px"}});
  console.heading("Attitude error of one image at zero tilt; the paper's camera has 12 and 37");
  const auto row = [&](const char* name, const std::string& words) {
    const Quantity* error = find_quantity(product, name);
    if (error != nullptr) console.line("  " + words + show(error->estimate, "arcsec"));
  };
  row("in_plane_error_arcsec", "in the image plane      ");
  row("out_of_plane_error_arcsec", "out of the image plane  ");
  console.heading(
      "Attitude error over the tilt, for the worst heading [arcsec]: in and out of the image "
      "plane");
  print_table(console, table_named(product, "degradation"),
              {{"tilt [deg]", "tilt_deg"},
               {"all in", "all_in_plane_arcsec"},
               {"out", "all_out_of_plane_arcsec"},
               {"one off in", "one_dark_in_plane_arcsec"},
               {"out", "one_dark_out_of_plane_arcsec"},
               {"calibration in", "calibration_in_plane_arcsec"},
               {"out", "calibration_out_of_plane_arcsec"},
               {"shift in", "principal_point_in_plane_arcsec"},
               {"out", "principal_point_out_of_plane_arcsec"},
               {"radial in", "radial_in_plane_arcsec"},
               {"out", "radial_out_of_plane_arcsec"},
               {"tangential in", "tangential_in_plane_arcsec"},
               {"out", "tangential_out_of_plane_arcsec"},
               {"free in", "free_in_plane_arcsec"},
               {"out", "free_out_of_plane_arcsec"}});
  console.line(
      "  one off: without the most important marker; calibration: each image displaced by " +
      show(run.study.calibration_px) +
      " px at random; shift: all images displaced by this; free: centre of rotation unknown");
  const Distortion& lens = run.study.distortion_error;
  console.line("  radial, tangential: error by uncalibrated distortion, k1, k2 " + show(lens.k1) +
               ", " + show(lens.k2) + "; p1, p2 " + show(lens.p1) + ", " + show(lens.p2));
  console.details().heading("Simulated images against the prediction [arcsec]");
  print_table(console.details(), table_named(product, "images"),
              {{"tilt [deg]", "tilt_deg"},
               {"heading [deg]", "heading_deg"},
               {"images", "images"},
               {"no pose", "without_pose"},
               {"in: predicted", "predicted_in_plane_arcsec"},
               {"found", "found_in_plane_arcsec"},
               {"out: predicted", "predicted_out_of_plane_arcsec"},
               {"found", "found_out_of_plane_arcsec"},
               {"chi2", "chi2_per_freedom"},
               {"+-", "chi2_standard_error"},
               {"chi2 of fit", "fit_chi2_per_freedom"}});
  console.details().line("  " + std::to_string(std::lround(run.images_per_s)) +
                         " images a second on one core, exposure simulated, read and solved");
}

RunResult run(const CommandOptions& options, const Console& console) {
  const CameraRun run = run_camera(options, console);
  print_camera(console, run);
  return run.result;
}

}  // namespace

Verb kind() {
  return {"camera",
          "Attitude error of a camera that tracks markers, computed from board, lens and sensor",
          command_that_writes(experiment_options, run),
          {"platform", "environment", "disturbance", "sensors", "camera_study"},
          "[sensors.camera] with markers"};
}

}  // namespace photorque::verbs::camera
