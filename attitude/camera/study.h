// Design study of a tracking camera: attitude error over tilt, board and lens, with one marker
// dark, and with calibration errors. Simulated images test the predicted errors.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "attitude/camera/pose.h"
#include "core/product.h"

namespace photorque {

struct CameraStudy {
  TrackingCamera camera;
  double max_tilt_rad = 0.5235987756;
  Vec3 rate_body_rad_s = Vec3::Zero();  // of the platform while images are taken
  double calibration_px = 0.1;
  // Error of the distortion in addition to that of the camera; its radial and tangential parts are
  // studied separately.
  Distortion distortion_error = {-0.1, 0.0, 1e-3, 1e-3};
  int images = 1000;  // simulated at each attitude of take_images()
  uint64_t seed = 1;
  int threads = 0;                     // of the maps; 0: all
  int grid = 61;                       // pixels of the maps along a side
  std::vector<double> focal_length_m;  // of the design map, rising, at least two
  std::vector<double> board_scale;     // likewise: factors on the markers' places
};

// Reads [camera_study], which may be absent; its keys are camera_study_table().
CameraStudy read_camera_study(const Settings& root, const TrackingCamera& camera,
                              std::optional<double> tilt_limit_rad);
Key camera_study_table();

// Tables "markers" and "degradation" (by tilt: all markers, the worst one dark, error of
// calibration, of distortion, both about the centre and free), "images" (predicted against
// simulated images); maps "in_plane_error", "out_of_plane_error" over the lean, "design_in_plane",
// "design_out_of_plane" over focal length and board; plots "error_over_tilt" and "design" (which
// board and lens give the paper's errors); headline figures.
Product camera_product(const CameraStudy& study, const std::function<void(double)>& progress = {});

}  // namespace photorque
