// The pose of the platform from where its markers are in an image.
#pragma once

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

// The pose with the least chi², by Levenberg and Marquardt's method (Ceres' TinySolver) from a
// first pose, that of the image before. The first pose's rate says how rows of a rolling shutter
// differ. Nothing where the markers are too few or it does not settle.
std::optional<FoundPose> find_pose(const TrackingCamera& camera,
                                   const std::vector<MarkerReading>& readings, const Pose& first);

}  // namespace photorque
