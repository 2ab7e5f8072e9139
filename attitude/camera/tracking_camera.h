// A camera that reads the platform's attitude from light-emitting diodes on it, from its geometry.
//
// Pinhole model (R. Hartley, A. Zisserman, Multiple View Geometry, 2nd ed., eq. 6.2) with the
// lens's distortion. What calibration leaves of it is `distortion_error`, or calibration_error() of
// attitude/camera/pose.h, other for every marker. Camera axes: z along the optical axis, image
// x (columns) along camera x, image y (rows) along camera y, the origin of the image in its middle.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/settings/keys.h"
#include "core/transform.h"

namespace photorque {

// Small light sources on the platform.
struct Marker {
  Vec3 position_body_m = Vec3::Zero();
  Vec3 normal_body = Vec3::UnitZ();  // unit: shines to this side
  bool is_lit = true;
};

// A lens's distortion by Brown and Conrady (D. Brown, Photogrammetric Engineering 32 (1966) 444),
// in OpenCV's convention: of x, y, the image over the focal length, r² = x² + y²,
//   x (1 + k₁r² + k₂r⁴) + 2 p₁xy + p₂(r² + 2x²),  y (1 + k₁r² + k₂r⁴) + p₁(r² + 2y²) + 2 p₂xy.
struct Distortion {
  double k1 = 0.0, k2 = 0.0;  // radial
  double p1 = 0.0, p2 = 0.0;  // tangential

  bool is_none() const { return k1 == 0.0 && k2 == 0.0 && p1 == 0.0 && p2 == 0.0; }
  Distortion operator+(const Distortion& other) const {
    return {k1 + other.k1, k2 + other.k2, p1 + other.p1, p2 + other.p2};
  }
  Vec2 distorted(const Vec2& undistorted) const;
  // Its derivative by the undistorted place.
  Eigen::Matrix2d slope(const Vec2& undistorted) const;
};

struct TrackingCamera {
  std::vector<Marker> markers;
  // True positions of the markers minus those that the pose assumes; one each, or empty.
  std::vector<Vec3> marker_error_body_m;
  double radiant_intensity_W_sr = 1e-4;  // of a marker along its normal
  double half_angle_rad = 1.0471975512;  // at which it has fallen to half: 60 deg is Lambert's law
  double wavelength_m = 630e-9;

  double focal_length_m = 8e-3;
  double f_number = 4.0;        // focal length over the diameter of the opening
  double transmittance = 0.85;  // of lens and filter
  double spot_px = 0.6;         // standard deviation of the spot besides diffraction and motion
  Distortion distortion;        // as it was calibrated: the pose uses it
  Distortion distortion_error;  // that of the lens, less that

  double pixel_m = 4.8e-6;
  int width = 1280, height = 1024;
  double exposure_s = 1e-4;
  double line_time_s = 0.0;  // rolling shutter: a row begins so much later than the one above it
  double quantum_efficiency = 0.5;
  double read_noise_electrons = 10.0;  // per pixel, one standard deviation
  double background_electrons = 0.0;   // per pixel and exposure, known in the mean
  double full_well_electrons = 10000.0;

  RigidTransform lab_from_camera;
  // The pose turns about the centre of the bearing, whose place is known; else position and
  // attitude are both found.
  bool knows_centre = true;
  // The pose weighs all markers alike, as solvers do that know no errors; else by the information
  // of their spots.
  bool weighs_alike = false;
  // Whether the platform stands between a marker and the camera; empty: it never does.
  std::function<bool(size_t marker, const Quat& lab_from_body)> is_hidden;

  // Whether the pose is wrong beyond noise.
  bool is_biased() const { return !marker_error_body_m.empty() || !distortion_error.is_none(); }
};

// Reads the geometry of [sensors.camera], whose keys are tracking_camera_keys(); nothing where
// there are no `markers_m`. InputError for fewer markers than the pose needs, or a spot that fills
// its pixels.
std::optional<TrackingCamera> read_tracking_camera(const Settings& settings);
std::vector<Key> tracking_camera_keys();

// One marker as the camera sees it at an instant.
struct MarkerView {
  size_t marker = 0;
  Vec2 pixel = Vec2::Zero();  // from the middle of the image
  double electrons = 0.0;     // of the whole spot
  // By a small rotation of the platform about lab axes and by a shift of its centre in the lab.
  Eigen::Matrix<double, 2, 6> derivative = Eigen::Matrix<double, 2, 6>::Zero();
  Vec2 smear_px = Vec2::Zero();  // displacement during the exposure
};

// Attitude and rate of the platform during the exposure of an image: the attitude is that at which
// the image's middle row is exposed.
struct Pose {
  Quat lab_from_body = Quat::Identity();
  Vec3 rate_lab_rad_s = Vec3::Zero();
  Vec3 centre_m = Vec3::Zero();  // of rotation, in the lab
};

// The image of a marker at the position that the pose assumes or, with `in_truth`, at the true
// position with the true distortion. Empty if the marker is hidden, turned away, outside the image,
// fainter than an electron, or blurred over more than 128 pixels.
std::optional<MarkerView> view_of(const TrackingCamera& camera, size_t marker, const Pose& pose,
                                  bool in_truth = false);

// Standard deviation [pixels] of a spot at rest: spot_px with diffraction, whose Airy disc is taken
// as a Gaussian of 0.42 λN (B. Zhang, J. Zerubia, J.-C. Olivo-Marin, Appl. Opt. 46 (2007) 1819,
// table 1: 0.21 λ/NA with NA = 1/(2N)).
double spot_sigma_px(const TrackingCamera& camera);

}  // namespace photorque
