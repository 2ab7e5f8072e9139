#include "attitude/camera/keys.h"

#include "attitude/camera/study.h"
#include "core/constants.h"

namespace photorque {

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
      Key::number_or("f_number", usual.f_number, {0.5, 1000.0}, "of the lens"),
      Key::number_or("transmittance", usual.transmittance, fraction, "of lens and filter"),
      Key::number_or("spot_px", usual.spot_px, {0.3, 50.0},
                     "standard deviation of a spot besides diffraction and motion"),
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
                     0, "what is known of the platform's place")};
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

}  // namespace photorque
