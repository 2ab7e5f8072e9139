// Design study of a tracking camera: attitude error as a function of tilt, board and lens, with one
// dark marker, and with calibration errors. Simulated images test the predicted errors.
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
  Vec3 rate_body_rad_s = Vec3::Zero();  // of the platform during the exposures
  double calibration_px = 0.1;
  // The part of the distortion that is not calibrated. Its radial and tangential parts are studied
  // separately.
  Distortion distortion_error = {-0.1, 0.0, 1e-3, 1e-3};
  int images = 1000;  // number simulated at each attitude
  uint64_t seed = 1;
  int threads = 0;                     // for the maps; 0: all
  int grid = 61;                       // bins of the maps along a side
  std::vector<double> focal_length_m;  // of the design map, increasing, at least two
  std::vector<double> board_scale;     // factors of the marker positions, like the focal lengths
};

// Reads [camera_study], which may be absent; its keys are those of camera_study_table().
CameraStudy read_camera_study(const Settings& root, const TrackingCamera& camera,
                              std::optional<double> tilt_limit_rad);
Key camera_study_table();

// The results of the study. Table "markers". Table "degradation" by tilt: all markers, the worst
// marker dark, errors of calibration and distortion, and a free pose. Table "images": predicted and
// simulated errors. Maps "in_plane_error" and "out_of_plane_error" over the tilt direction; maps
// "design_in_plane_error" and "design_out_of_plane_error" over focal length and board. Plots
// "error_over_tilt" and "design" (boards and lenses with the errors of the paper). Headline
// figures.
Product camera_product(const CameraStudy& study, const std::function<void(double)>& progress = {});

}  // namespace photorque
