// The keys of a camera that sees markers, and [camera_study].
#pragma once

#include <vector>

#include "core/constants.h"
#include "core/settings/typed_keys.h"

namespace photorque {

namespace tracking_key {
inline constexpr Vec3sKey markers(
    "markers_m",
    "positions of the markers, body axes; at least two, four for a free pose. The noise then "
    "follows from board, lens and sensor instead of `noise_arcsec`",
    {.optional = true});
inline constexpr Vec3Key marker_normal("marker_normal", {0.0, 0.0, 1.0},
                                       "direction of their emission, body axes, any length");
inline constexpr Vec3sKey marker_error("marker_error_m",
                                       "one per marker: true position minus `markers_m`; affects "
                                       "recorded attitudes, but not the filter",
                                       {.usually = "none"});
inline constexpr NumberKey intensity("intensity_W_sr", Range::positive(),
                                     "radiant intensity of a marker along its normal",
                                     {.optional = true});
inline constexpr NumberKey half_angle(
    "half_angle_deg", {0.0, 0.5 * pi, true, true},
    "angle of half the intensity, which is a power of the cosine; 60 is Lambert's law",
    {.optional = true});
inline constexpr NumberKey wavelength("wavelength_nm", {1e-7, 2e-6}, "of the markers",
                                      {.optional = true});
inline constexpr NumberKey focal_length("focal_length_mm", Range::positive(), "of the lens",
                                        {.optional = true});
inline constexpr NumberKey f_number("f_number", {0.5, 128.0}, "of the lens", {.optional = true});
inline constexpr NumberKey transmittance("transmittance", {0.0, 1.0, true, false},
                                         "of lens and filter", {.optional = true});
inline constexpr NumberKey spot("spot_px", {0.3, 50.0},
                                "standard deviation of a spot without diffraction and motion",
                                {.optional = true});
inline constexpr NumbersKey distortion(
    "distortion", {-10.0, 10.0},
    "calibrated distortion of the lens: [k1, k2, p1, p2], radial and "
    "tangential, as OpenCV defines them",
    {.usually = "none", .size = 4});
inline constexpr NumbersKey distortion_error(
    "distortion_error", {-10.0, 10.0},
    "true distortion minus `distortion`; affects recorded attitudes, but not the filter",
    {.usually = "none", .size = 4});
inline constexpr NumberKey pixel("pixel_um", {1e-7, 1e-3}, "of the sensor", {.optional = true});
inline constexpr NumbersKey resolution("resolution", {8.0, 65536.0},
                                       "of the sensor: [columns, rows]",
                                       {.optional = true, .size = 2});
inline constexpr NumberKey exposure("exposure_s", Range::positive(),
                                    "no pixel may be beyond the full well at zero tilt",
                                    {.optional = true});
inline constexpr NumberKey line_time("line_time_s", Range::not_negative(),
                                     "rolling shutter: delay of each row after the one above",
                                     {.optional = true});
inline constexpr NumberKey quantum_efficiency("quantum_efficiency", {0.0, 1.0, true, false},
                                              "of the sensor", {.optional = true});
inline constexpr NumberKey read_noise_electrons("read_noise_electrons", Range::positive(),
                                                "of a pixel", {.optional = true});
inline constexpr NumberKey background_electrons("background_electrons", Range::not_negative(),
                                                "of a pixel in an exposure", {.optional = true});
inline constexpr NumberKey full_well_electrons("full_well_electrons", Range::positive(),
                                               "of a pixel", {.optional = true});
inline constexpr Vec3Key position("position_m", "of the camera, lab axes", {.optional = true});
inline constexpr Vec3Key aim("aim_m", {0.0, 0.0, 0.0}, "a point on the optical axis, lab axes");
inline constexpr ChoiceKey pose("pose",
                                {{"about_centre", "the centre of rotation is known"},
                                 {"free", "the position is estimated too"}},
                                0, "knowledge of the platform's position");
inline constexpr ChoiceKey pose_weights("pose_weights",
                                        {{"information",
                                          "by the Fisher information of their images"},
                                         {"equal", "the same for all markers"}},
                                        0, "weights of the markers in the pose");
}  // namespace tracking_key

namespace study_key {
inline constexpr NumberKey max_tilt("max_tilt_deg", {0.0, 0.5 * pi, true, true},
                                    "largest tilt in the tables",
                                    {.usually = "the platform's stop, else 30"});
inline constexpr Vec3Key rate("rate_rad_s", {0.0, 0.0, 0.0},
                              "of the platform while images are taken, body axes");
inline constexpr NumberKey calibration("calibration_px", Range::positive(),
                                       "calibration error assumed in the tables",
                                       {.optional = true});
inline constexpr NumbersKey distortion_error(
    "distortion_error", {-10.0, 10.0},
    "uncalibrated distortion assumed in the tables: [k1, k2, p1, p2]",
    {.usually = "[-0.1, 0, 1e-3, 1e-3]", .size = 4});
inline constexpr IntegerKey images("images", 10, 1'000'000,
                                   "number of images simulated at each of four attitudes",
                                   {.optional = true});
inline constexpr IntegerKey grid("grid", 5, 1000, "bins of the maps along a side",
                                 {.optional = true});
inline constexpr NumbersKey focal_length("focal_length_mm", Range::positive(),
                                         "[from, to] of the map over lens and board",
                                         {.usually = "0.75 to 1.5 times the lens", .size = 2});
inline constexpr NumbersKey board_scale("board_scale", Range::positive(),
                                        "[from, to] of the scale of the board in this map",
                                        {.usually = "[0.5, 2]", .size = 2});
inline constexpr TableKey camera_study("camera_study", "tables and maps of the command `camera`");
}  // namespace study_key

// read_tracking_camera().
std::vector<Key> tracking_camera_keys();
Key camera_study_table();

}  // namespace photorque
