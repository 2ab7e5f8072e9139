// The pose of the platform from the image positions of its markers.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "attitude/camera/spot.h"

namespace photorque {

// The measured image position of a marker, from the centre of the image, and its covariance.
struct MarkerReading {
  size_t marker = 0;
  Vec2 pixel = Vec2::Zero();
  Mat2 covariance_px2 = Mat2::Identity();
};

struct FoundPose {
  Pose pose;
  double chi2 = 0.0;  // of the readings relative to it
  int readings = 0;   // number of coordinates read: two per marker
  int unknowns = 0;   // 3 with known centre, 6 for a free pose
};

// The pose with the least χ², by the Levenberg–Marquardt method from `first`, the pose of the
// previous image. The rate of `first` determines the differences of rows with a rolling shutter.
// nullopt if there are too few markers or the fit does not converge.
std::optional<FoundPose> find_pose(const TrackingCamera& camera,
                                   const std::vector<MarkerReading>& readings, const Pose& first);

// Covariance of the attitude error from one image [rad²], as a rotation vector about lab axes: the
// inverse of the information of all visible markers. nullopt if they do not determine the attitude.
std::optional<Mat3> attitude_covariance_lab_rad2(const TrackingCamera& camera, const Pose& pose);

// Covariance from a constant calibration error that is unknown to the pose: the image of every
// marker is displaced by `error_px` (one standard deviation per axis, independent of the others).
std::optional<Mat3> calibration_error_lab_rad2(const TrackingCamera& camera, const Pose& pose,
                                               double error_px);
// Covariance from an error of the principal point of `error_px` per axis, common to all markers.
std::optional<Mat3> principal_point_error_lab_rad2(const TrackingCamera& camera, const Pose& pose,
                                                   double error_px);

// Errors [rad] about the optical axis (in plane), and the root mean square about the two axes
// perpendicular to it (out of plane).
struct PlaneErrors {
  double in_plane_rad = 0.0;
  double out_of_plane_rad = 0.0;
};
PlaneErrors plane_errors(const TrackingCamera& camera, const Mat3& covariance_lab_rad2);

// The attitude error due to wrong marker positions: that of the least-χ² pose for noiseless images
// of the true markers. Rotation vector about lab axes [rad].
std::optional<Vec3> marker_bias_lab_rad(const TrackingCamera& camera, const Pose& pose);

// Simulates one image: every visible marker is exposed and read, and the pose is found from
// `first`. The motion of the spots is that of `first`.
struct ImageResult {
  FoundPose found;
  Vec3 error_lab_rad = Vec3::Zero();  // of the attitude
};
std::optional<ImageResult> take_image(const TrackingCamera& camera, const Pose& truth,
                                      const Pose& first, uint64_t seed, uint64_t image);

// Statistics of many images of one pose.
struct ImageStatistics {
  int images = 0;
  int failed = 0;  // number of images without a pose
  // Mean of error² relative to the prediction, per degree of freedom: expected 1.
  double chi2 = 0.0;
  double chi2_fit = 0.0;           // of the readings about the pose found, per degree of freedom
  Mat3 covariance = Mat3::Zero();  // of the errors about lab axes [rad²]
  Vec3 mean_rad = Vec3::Zero();
};
ImageStatistics take_images(const TrackingCamera& camera, const Pose& truth, int images,
                            uint64_t seed, const Mat3& predicted_lab_rad2);

}  // namespace photorque
