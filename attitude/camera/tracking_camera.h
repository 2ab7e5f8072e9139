// A camera that measures the platform's attitude from light-emitting diodes on it, modelled by its
// geometry.
//
// Pinhole model (R. Hartley, A. Zisserman, Multiple View Geometry, 2nd ed., eq. 6.2) with the
// lens's distortion. The remaining calibration error is `distortion_error`, or a separate error for
// every marker, calibration_error_lab_rad2() in attitude/camera/pose.h. Camera axes: z along the
// optical axis, image x (columns) along camera x, image y (rows) along camera y. The origin of the
// image is its centre.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/settings/typed_keys.h"
#include "core/transform.h"

namespace photorque {

// Small light sources on the platform.
struct Marker {
  Vec3 position_body_m = Vec3::Zero();
  Vec3 normal_body = Vec3::UnitZ();  // unit vector to the side on which it emits
  bool is_lit = true;
};

// Distortion of a lens by Brown and Conrady (D. Brown, Photogrammetric Engineering 32 (1966) 444),
// in OpenCV's convention. With the image position over the focal length, x and y, and r² = x² + y²:
//   x (1 + k₁r² + k₂r⁴) + 2 p₁xy + p₂(r² + 2x²),  y (1 + k₁r² + k₂r⁴) + p₁(r² + 2y²) + 2 p₂xy.
struct Distortion {
  double k1 = 0.0, k2 = 0.0;  // radial
  double p1 = 0.0, p2 = 0.0;  // tangential

  bool is_none() const { return k1 == 0.0 && k2 == 0.0 && p1 == 0.0 && p2 == 0.0; }
  Distortion operator+(const Distortion& other) const {
    return {k1 + other.k1, k2 + other.k2, p1 + other.p1, p2 + other.p2};
  }
  Vec2 distorted(const Vec2& undistorted) const;
  // Derivative of the distorted with respect to the undistorted position.
  Eigen::Matrix2d slope(const Vec2& undistorted) const;
};

// Reads [k1, k2, p1, p2]; zero if the key is absent.
Distortion read_distortion(const Settings& settings, const NumbersKey& key);

// Markers, lens and sensor.
struct CameraParts {
  double radiant_intensity_W_sr = 1e-4;  // of a marker along its normal
  double half_angle_rad = 1.0471975512;  // at half of this intensity; 60 deg: Lambert's law
  double wavelength_m = 630e-9;

  double focal_length_m = 8e-3;
  double f_number = 4.0;        // focal length over aperture diameter
  double transmittance = 0.85;  // of lens and filter
  double spot_px = 0.6;         // standard deviation of the spot without diffraction and motion

  double pixel_m = 4.8e-6;
  int width = 1280, height = 1024;
  double exposure_s = 1e-4;
  double line_time_s = 0.0;  // rolling shutter: delay of each row after the one above
  double quantum_efficiency = 0.5;
  double read_noise_electrons = 10.0;  // per pixel, one standard deviation
  double background_electrons = 0.0;   // per pixel and exposure; the mean is known
  double full_well_electrons = 10000.0;
};

struct TrackingCamera : CameraParts {
  std::vector<Marker> markers;
  // True positions of the markers minus the assumed positions; one for each marker, or empty.
  std::vector<Vec3> marker_error_body_m;
  Distortion distortion;        // calibrated; used by the pose
  Distortion distortion_error;  // true distortion minus `distortion`

  RigidTransform lab_from_camera;
  // true: the platform rotates about the centre of the bearing, whose position is known. false:
  // position and attitude are estimated.
  bool knows_centre = true;
  // true: the pose weights all markers equally, as solvers without error estimates do. false: by
  // the information of their spots.
  bool weighs_alike = false;
  // Whether the platform hides a marker from the camera; empty: never.
  std::function<bool(size_t marker, const Quat& lab_from_body)> is_hidden;

  // Whether the pose has errors in addition to noise.
  bool is_biased() const { return !marker_error_body_m.empty() || !distortion_error.is_none(); }
};

// Reads the geometry of [sensors.camera], whose keys are tracking_camera_keys(). nullopt without
// `markers_m`. InputError for fewer markers than the pose needs, or a spot above the full well of a
// pixel.
std::optional<TrackingCamera> read_tracking_camera(const Settings& settings);
std::vector<Key> tracking_camera_keys();

// The image of one marker at an instant.
struct MarkerView {
  size_t marker = 0;
  Vec2 pixel = Vec2::Zero();  // from the centre of the image
  double electrons = 0.0;     // of the whole spot
  // Derivative with respect to a small rotation of the platform about lab axes and a shift of its
  // centre in the lab.
  Eigen::Matrix<double, 2, 6> derivative = Eigen::Matrix<double, 2, 6>::Zero();
  Vec2 smear_px = Vec2::Zero();  // displacement during the exposure
};

// Attitude and rate of the platform during the exposure of an image. The attitude is that during
// the exposure of the middle row.
struct Pose {
  Quat lab_from_body = Quat::Identity();
  Vec3 rate_lab_rad_s = Vec3::Zero();
  Vec3 centre_m = Vec3::Zero();  // of rotation, in the lab
};

// The image of a marker at its assumed position or, with `in_truth`, at the true position with the
// true distortion. Empty if the marker is not lit, hidden, turned away, outside the image, fainter
// than an electron, or smeared over more than 128 pixels.
std::optional<MarkerView> view_of(const TrackingCamera& camera, size_t marker, const Pose& pose,
                                  bool in_truth = false);

// Standard deviation [pixels] of a spot at rest: spot_px with diffraction, whose Airy disc is
// approximated by a Gaussian of 0.42 λN (B. Zhang, J. Zerubia, J.-C. Olivo-Marin, Appl. Opt. 46
// (2007) 1819, table 1: 0.21 λ/NA with NA = 1/(2N)).
double spot_sigma_px(const TrackingCamera& camera);

}  // namespace photorque
