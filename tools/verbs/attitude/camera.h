// Attitude error of the tracking camera of an experiment.
#pragma once

#include "attitude/camera/study.h"
#include "tools/runs/console.h"
#include "tools/runs/options.h"
#include "tools/runs/result.h"

namespace photorque {

struct CameraRun {
  CameraStudy study;
  double images_per_s = 0.0;  // images that are exposed, read and solved per second on one thread
  RunResult result;
};

// Computes the attitude error of the camera by [camera_study]. Throws InputError for invalid input.
CameraRun run_camera(const RunOptions& options, const Console& console);

}  // namespace photorque
