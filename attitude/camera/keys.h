// The keys of a camera that sees markers, and [camera_study].
#pragma once

#include <vector>

#include "core/constants.h"
#include "core/settings/typed_keys.h"

namespace photorque {

namespace tracking_key {

inline constexpr auto markers =
    Vec3sKey{"markers_m",
             "places of the markers, body axes, two or more, four of a free pose: "
             "the noise then follows from board, lens and sensor, in place of "
             "`noise_arcsec`"}
        .optional();
inline constexpr Vec3Key marker_normal{
    "marker_normal", {0.0, 0.0, 1.0}, "where they shine to, body axes, any length"};
inline constexpr auto marker_error =
    Vec3sKey{"marker_error_m",
             "one per marker: where they are in truth, less `markers_m`; turns every attitude "
             "that is recorded, and the filter does not know"}
        .usually("none");
inline constexpr auto intensity =
    NumberKey{"intensity_W_sr", Range::positive(), "radiant intensity of a marker along its normal"}
        .optional();
inline constexpr auto half_angle =
    NumberKey{"half_angle_deg",
              {0.0, 0.5 * pi, true, true},
              "at which it has fallen to half, by a power of the cosine: 60 is Lambert's law"}
        .optional();
inline constexpr auto wavelength =
    NumberKey{"wavelength_nm", {1e-7, 2e-6}, "of the markers"}.optional();
inline constexpr auto focal_length =
    NumberKey{"focal_length_mm", Range::positive(), "of the lens"}.optional();
inline constexpr auto f_number = NumberKey{"f_number", {0.5, 128.0}, "of the lens"}.optional();
inline constexpr auto transmittance =
    NumberKey{"transmittance", {0.0, 1.0, true, false}, "of lens and filter"}.optional();
inline constexpr auto spot =
    NumberKey{"spot_px", {0.3, 50.0}, "standard deviation of a spot besides diffraction and motion"}
        .optional();
inline constexpr auto distortion =
    NumbersKey{"distortion",
               {-10.0, 10.0},
               "of the lens as calibrated, which the pose knows: [k1, k2, p1, p2], radial and "
               "tangential, as OpenCV defines them"}
        .of_size(4)
        .usually("none");
inline constexpr auto distortion_error =
    NumbersKey{"distortion_error",
               {-10.0, 10.0},
               "that of the lens, less `distortion`: turns every attitude that is recorded, and "
               "the filter does not know"}
        .of_size(4)
        .usually("none");
inline constexpr auto pixel = NumberKey{"pixel_um", {1e-7, 1e-3}, "of the sensor"}.optional();
inline constexpr auto resolution =
    NumbersKey{"resolution", {8.0, 65536.0}, "of the sensor: [columns, rows]"}
        .of_size(2)
        .optional();
inline constexpr auto exposure =
    NumberKey{"exposure_s", Range::positive(), "no pixel may be beyond the full well at zero tilt"}
        .optional();
inline constexpr auto line_time =
    NumberKey{"line_time_s", Range::not_negative(),
              "rolling shutter: a row begins so much after the one above it"}
        .optional();
inline constexpr auto quantum_efficiency =
    NumberKey{"quantum_efficiency", {0.0, 1.0, true, false}, "of the sensor"}.optional();
inline constexpr auto read_noise_electrons =
    NumberKey{"read_noise_electrons", Range::positive(), "of a pixel"}.optional();
inline constexpr auto background_electrons =
    NumberKey{"background_electrons", Range::not_negative(), "of a pixel in an exposure"}
        .optional();
inline constexpr auto full_well_electrons =
    NumberKey{"full_well_electrons", Range::positive(), "of a pixel"}.optional();
inline constexpr auto position = Vec3Key{"position_m", "of the camera, lab axes"}.optional();
inline constexpr Vec3Key aim{"aim_m", {0.0, 0.0, 0.0}, "where its optical axis passes, lab axes"};
inline constexpr ChoiceKey pose{
    "pose",
    {{"about_centre", "the centre of rotation is known"}, {"free", "the position is found too"}},
    0,
    "what is known of the platform's place"};
inline constexpr ChoiceKey pose_weights{
    "pose_weights",
    {{"information", "the more a spot's image says of its centre"},
     {"equal", "as solvers do that know no errors"}},
    0,
    "how the pose weighs markers"};

}  // namespace tracking_key

namespace study_key {

inline constexpr auto max_tilt =
    NumberKey{"max_tilt_deg", {0.0, 0.5 * pi, true, true}, "of the tables"}.usually(
        "the platform's stop, else 30");
inline constexpr Vec3Key rate{
    "rate_rad_s", {0.0, 0.0, 0.0}, "of the platform while images are taken, body axes"};
inline constexpr auto calibration =
    NumberKey{"calibration_px", Range::positive(), "error of calibration in the tables"}.optional();
inline constexpr auto distortion_error =
    NumbersKey{"distortion_error",
               {-10.0, 10.0},
               "[k1, k2, p1, p2] that no calibration knows, in the tables"}
        .of_size(4)
        .usually("[-0.1, 0, 1e-3, 1e-3]");
inline constexpr auto images =
    IntegerKey{"images", 10, 1'000'000, "simulated at each of four attitudes"}.optional();
inline constexpr auto grid =
    IntegerKey{"grid", 5, 1000, "bins of the maps along a side"}.optional();
inline constexpr auto focal_length =
    NumbersKey{"focal_length_mm", Range::positive(), "[from, to] of the map over lens and board"}
        .of_size(2)
        .usually("0.75 to 1.5 times the lens");
inline constexpr auto board_scale =
    NumbersKey{"board_scale", Range::positive(), "[from, to] of the same map"}.of_size(2).usually(
        "[0.5, 2]");
inline constexpr TableKey camera_study{"camera_study", "what `camera` looks at"};

}  // namespace study_key

// read_tracking_camera().
std::vector<Key> tracking_camera_keys();
Key camera_study_table();

}  // namespace photorque
