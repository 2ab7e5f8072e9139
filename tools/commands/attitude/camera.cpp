// photorque camera: how well the tracking camera knows the attitude, by its geometry.
#include "tools/tracking/camera.h"

#include <cmath>

#include "core/constants.h"
#include "core/errors.h"
#include "tools/commands/results.h"
#include "tools/commands/terminal.h"

namespace photorque::kinds::camera {
namespace {

const Table& camera_table(const Product& product, const std::string& name) {
  for (const Table& table : product.tables) {
    if (table.name == name) return table;
  }
  throw NumericalError("the camera's study has no table " + name);
}

void print_camera(const Console& console, const CameraRun& run) {
  const TrackingCamera& camera = run.study.camera;
  const Product& product = run.result.product;
  console.line(std::to_string(camera.markers.size()) + " markers, " +
               show(camera.focal_length_m * 1e3) + " mm f/" + show(camera.f_number) + ", " +
               std::to_string(camera.width) + " x " + std::to_string(camera.height) +
               " pixels of " + show(camera.pixel_m * 1e6) + " um, exposure " +
               show(camera.exposure_s * 1e6) + " us, spots " + show(spot_sigma_px(camera)) +
               " px; pose " + (camera.knows_centre ? "about the centre of the bearing" : "free"));
  console.heading("Markers in the image at zero tilt");
  print_table(console, camera_table(product, "markers"),
              {{"x [m]", "x_m"},
               {"y [m]", "y_m"},
               {"z [m]", "z_m"},
               {"column", "column_px"},
               {"row", "row_px"},
               {"electrons", "electrons"},
               {"brightest pixel", "brightest_pixel_electrons"},
               {"error [px]", "centre_error_px"}});
  console.heading("Attitude error of one image at zero tilt; the paper's camera has 12 and 37");
  for (const Quantity& quantity : product.quantities) {
    if (quantity.name == "in_plane_error_arcsec") {
      console.line("  in the image plane      " + show(quantity.estimate, "arcsec"));
    } else if (quantity.name == "out_of_plane_error_arcsec") {
      console.line("  out of the image plane  " + show(quantity.estimate, "arcsec"));
    }
  }
  console.heading("By tilt, the worst heading [arcsec]: in the image plane, out of it");
  print_table(console, camera_table(product, "degradation"),
              {{"tilt [deg]", "tilt_deg"},
               {"all in", "all_in_plane_arcsec"},
               {"out", "all_out_of_plane_arcsec"},
               {"one dark in", "one_dark_in_plane_arcsec"},
               {"out", "one_dark_out_of_plane_arcsec"},
               {"calibration in", "calibration_in_plane_arcsec"},
               {"out", "calibration_out_of_plane_arcsec"},
               {"middle in", "principal_point_in_plane_arcsec"},
               {"out", "principal_point_out_of_plane_arcsec"},
               {"radial in", "radial_in_plane_arcsec"},
               {"out", "radial_out_of_plane_arcsec"},
               {"tangential in", "tangential_in_plane_arcsec"},
               {"out", "tangential_out_of_plane_arcsec"},
               {"free in", "free_in_plane_arcsec"},
               {"out", "free_out_of_plane_arcsec"}});
  console.line("  calibration: each marker's image off by " + show(run.study.calibration_px) +
               " px, independently; middle: all alike (principal point); free: centre not known");
  const Distortion& lens = run.study.distortion_error;
  console.line("  radial, tangential: the turn by a distortion that is not calibrated, k1, k2 " +
               show(lens.k1) + ", " + show(lens.k2) + "; p1, p2 " + show(lens.p1) + ", " +
               show(lens.p2));
  console.heading("Simulated images against the prediction [arcsec]");
  print_table(console, camera_table(product, "images"),
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
  console.line("  " + std::to_string(std::lround(run.images_per_s)) +
               " images a second on one core, exposure simulated, read and solved");
}

void run_camera(const CommandLine& line) {
  const Console console = terminal(line);
  const CameraRun run = camera_of_experiment(line, console);
  print_camera(console, run);
  write_results(line, console, run.result);
}

}  // namespace

Verb kind() {
  return {"camera", "How well a camera that tracks markers knows the attitude, by its geometry",
          run_camera};
}

}  // namespace photorque::kinds::camera
