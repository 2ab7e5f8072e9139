// How well the tracking camera of an experiment knows the attitude.
#pragma once

#include "attitude/camera/study.h"
#include "tools/runs/attitude_run.h"
#include "tools/runs/result.h"

namespace photorque {

struct CameraRun {
  CameraStudy study;
  double images_per_s = 0.0;  // exposed, read and solved, on one thread
  RunResult result;
};

CameraRun camera_of_experiment(const RunOptions& options, const Console& console);

}  // namespace photorque
