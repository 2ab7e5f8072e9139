#include "attitude/camera/keys.h"

#include "attitude/camera/study.h"
#include "core/constants.h"

namespace photorque {
namespace {

std::vector<double> read_study_span(const Settings& s, const std::string& key, double low,
                                    double high) {
  if (!s.has(key)) return {low, high};
  std::vector<double> span = s.numbers(key, Range::positive());
  if (span.size() != 2 || !(span[0] < span[1])) {
    throw s.error(key, std::to_string(span.size()) + " numbers", "[from, to]");
  }
  return span;
}

}  // namespace

std::vector<Key> tracking_camera_keys() {
  const TrackingCamera usual;
  const Range fraction{0.0, 1.0, true, false};
  const auto of_camera = [](Key key) { return std::move(key).optional(); };
  return {
      of_camera(Key::vectors3("markers_m",
                              "places of the markers, body axes, two or more, four of a free pose: "
                              "the noise then follows from board, lens and sensor, in place of "
                              "`noise_arcsec`")),
      Key::vector3_or("marker_normal", Vec3::UnitZ(), "where they shine to, body axes, any length"),
      Key::vectors3(
          "marker_error_m",
          "one per marker: where they are in truth, less `markers_m`; turns every attitude "
          "that is recorded, and the filter does not know")
          .usually_is("none"),
      of_camera(Key::number("intensity_W_sr", Range::positive(),
                            "radiant intensity of a marker along its normal")),
      Key::number_or(
          "half_angle_deg", usual.half_angle_rad, {0.0, 0.5 * pi, true, true},
          "at which it has fallen to half, by a power of the cosine: 60 is Lambert's law"),
      Key::number_or("wavelength_nm", usual.wavelength_m, {1e-7, 2e-6}, "of the markers"),
      of_camera(Key::number("focal_length_mm", Range::positive(), "of the lens")),
      Key::number_or("f_number", usual.f_number, {0.5, 128.0}, "of the lens"),
      Key::number_or("transmittance", usual.transmittance, fraction, "of lens and filter"),
      Key::number_or("spot_px", usual.spot_px, {0.3, 50.0},
                     "standard deviation of a spot besides diffraction and motion"),
      Key::numbers("distortion", {-10.0, 10.0},
                   "of the lens as calibrated, which the pose knows: [k1, k2, p1, p2], radial and "
                   "tangential, as OpenCV defines them")
          .of_size(4)
          .usually_is("none"),
      Key::numbers(
          "distortion_error", {-10.0, 10.0},
          "that of the lens, less `distortion`: turns every attitude that is recorded, and "
          "the filter does not know")
          .of_size(4)
          .usually_is("none"),
      of_camera(Key::number("pixel_um", {1e-7, 1e-3}, "of the sensor")),
      of_camera(
          Key::numbers("resolution", {8.0, 65536.0}, "of the sensor: [columns, rows]").of_size(2)),
      of_camera(Key::number("exposure_s", Range::positive(),
                            "no pixel may be beyond the full well at zero tilt")),
      Key::number_or("line_time_s", usual.line_time_s, Range::not_negative(),
                     "rolling shutter: a row begins so much after the one above it"),
      Key::number_or("quantum_efficiency", usual.quantum_efficiency, fraction, "of the sensor"),
      Key::number_or("read_noise_electrons", usual.read_noise_electrons, Range::positive(),
                     "of a pixel"),
      Key::number_or("background_electrons", usual.background_electrons, Range::not_negative(),
                     "of a pixel in an exposure"),
      Key::number_or("full_well_electrons", usual.full_well_electrons, Range::positive(),
                     "of a pixel"),
      of_camera(Key::vector3("position_m", "of the camera, lab axes")),
      Key::vector3_or("aim_m", Vec3::Zero(), "where its optical axis passes, lab axes"),
      Key::choice_or("pose",
                     {{"about_centre", "the centre of rotation is known"},
                      {"free", "the position is found too"}},
                     0, "what is known of the platform's place"),
      Key::choice_or("pose_weights",
                     {{"information", "the more a spot's image says of its centre"},
                      {"equal", "as solvers do that know no errors"}},
                     0, "how the pose weighs markers")};
}

Key camera_study_table() {
  const CameraStudy usual;
  return Key::table("camera_study",
                    {Key::number("max_tilt_deg", {0.0, 0.5 * pi, true, true}, "of the tables")
                         .usually_is("the platform's stop, else 30"),
                     Key::vector3_or("rate_rad_s", Vec3::Zero(),
                                     "of the platform while images are taken, body axes"),
                     Key::number_or("calibration_px", usual.calibration_px, Range::positive(),
                                    "error of calibration in the tables"),
                     Key::numbers("distortion_error", {-10.0, 10.0},
                                  "[k1, k2, p1, p2] that no calibration knows, in the tables")
                         .of_size(4)
                         .usually_is("[-0.1, 0, 1e-3, 1e-3]"),
                     Key::integer_or("images", usual.images, 10, 1'000'000,
                                     "simulated at each of four attitudes"),
                     Key::integer_or("grid", usual.grid, 5, 1000, "bins of the maps along a side"),
                     Key::numbers("focal_length_mm", Range::positive(),
                                  "[from, to] of the map over lens and board")
                         .of_size(2)
                         .usually_is("0.75 to 1.5 times the lens"),
                     Key::numbers("board_scale", Range::positive(), "[from, to] of the same map")
                         .of_size(2)
                         .usually_is("[0.5, 2]")},
                    "what `camera` looks at");
}

CameraStudy read_camera_study(const Settings& root, const TrackingCamera& camera,
                              std::optional<double> tilt_limit_rad) {
  CameraStudy study;
  study.camera = camera;
  study.max_tilt_rad = tilt_limit_rad.value_or(study.max_tilt_rad);
  study.focal_length_m = {0.75 * camera.focal_length_m, 1.5 * camera.focal_length_m};
  study.board_scale = {0.5, 2.0};
  if (!root.has("camera_study")) return study;
  const Settings own(std::make_shared<const SettingsNode>(root.raw("camera_study")),
                     root.table("camera_study").name());
  study.max_tilt_rad =
      own.number_or("max_tilt_deg", study.max_tilt_rad, {0.0, 0.5 * pi, true, true});
  study.rate_body_rad_s = own.vector3_or("rate_rad_s", Vec3::Zero());
  study.calibration_px = own.number_or("calibration_px", study.calibration_px, Range::positive());
  if (own.has("distortion_error")) {
    const std::vector<double> numbers = own.numbers("distortion_error", {-10.0, 10.0});
    if (numbers.size() != 4) {
      throw own.error("distortion_error", std::to_string(numbers.size()) + " numbers",
                      "[k1, k2, p1, p2]");
    }
    study.distortion_error = {numbers[0], numbers[1], numbers[2], numbers[3]};
  }
  study.images = static_cast<int>(own.integer_or("images", study.images, 10, 1'000'000));
  study.grid = static_cast<int>(own.integer_or("grid", study.grid, 5, 1000));
  study.focal_length_m =
      read_study_span(own, "focal_length_mm", study.focal_length_m[0], study.focal_length_m[1]);
  study.board_scale =
      read_study_span(own, "board_scale", study.board_scale[0], study.board_scale[1]);
  own.finish();
  return study;
}

}  // namespace photorque
