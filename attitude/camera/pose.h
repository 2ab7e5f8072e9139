// The pose of the platform from where its markers are in an image.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "attitude/camera/spot.h"

namespace photorque {

// Where a marker was read, from the middle of the image, and how well.
struct MarkerReading {
  size_t marker = 0;
  Vec2 pixel = Vec2::Zero();
  Mat2 covariance_px2 = Mat2::Identity();
};

struct FoundPose {
  Pose pose;
  double chi2 = 0.0;  // of the readings about it
  int readings = 0;   // numbers read: two per marker
  int unknowns = 0;   // 3 about the centre, 6 free
};

// The pose with the least chi², by Levenberg and Marquardt's method from a
// first pose, that of the image before. The first pose's rate says how rows of a rolling shutter
// differ. Nothing where the markers are too few or it does not settle.
std::optional<FoundPose> find_pose(const TrackingCamera& camera,
                                   const std::vector<MarkerReading>& readings, const Pose& first);

// The error of a tracking camera's attitude, predicted from its geometry and from images.

// Covariance of the attitude read from one image, of its error as a rotation vector about lab axes
// [rad²]: the inverse of the information of all markers in sight. Nothing where they do not fix it.
std::optional<Mat3> attitude_covariance_lab_rad2(const TrackingCamera& camera, const Pose& pose);

// Covariance from errors of calibration that stay: every marker's image is displaced by `error_px`
// (one standard deviation per axis, independent of the others) and the pose does not know.
std::optional<Mat3> calibration_error_lab_rad2(const TrackingCamera& camera, const Pose& pose,
                                               double error_px);
// And of a principal point that is wrong by `error_px` per axis, for all markers alike.
std::optional<Mat3> principal_point_error_lab_rad2(const TrackingCamera& camera, const Pose& pose,
                                                   double error_px);

// Errors [rad] about the optical axis (in the image plane) and about the two axes across it: one
// each, and the root of their mean square.
struct PlaneErrors {
  double in_plane_rad = 0.0;
  double out_of_plane_rad = 0.0;
  Vec2 across_rad = Vec2::Zero();
};
PlaneErrors plane_errors(const TrackingCamera& camera, const Mat3& covariance_lab_rad2);

// The attitude error of wrong marker positions: where the least chi² lies when the readings are
// those of the true markers without noise. Rotation vector about lab axes [rad].
std::optional<Vec3> marker_bias_lab_rad(const TrackingCamera& camera, const Pose& pose);

// One image: every marker in sight exposed and read, and the pose found from `first`, which is also
// what the spots' motion is taken from.
struct ImageResult {
  FoundPose found;
  Vec3 error_lab_rad = Vec3::Zero();  // of the attitude found
};
std::optional<ImageResult> take_image(const TrackingCamera& camera, const Pose& truth,
                                      const Pose& first, uint64_t seed, uint64_t image);

// Many images of one pose.
struct ImageStatistics {
  int images = 0;
  int failed = 0;         // without a pose
  double chi2 = 0.0;      // mean of error² against `predicted`, per degree of freedom: expected 1
  double chi2_fit = 0.0;  // of the readings about the pose found, per degree of freedom
  Mat3 covariance = Mat3::Zero();  // of the errors about lab axes [rad²]
  Vec3 mean_rad = Vec3::Zero();
};
ImageStatistics take_images(const TrackingCamera& camera, const Pose& truth, int images,
                            uint64_t seed, const Mat3& predicted_lab_rad2);

}  // namespace photorque
