// Least squares of a whole trajectory to a recording: the initial state, and the parameters of
// disturbances, that make the model pass closest to what the instruments read.
//
// Gauss–Newton with Levenberg's damping on exact derivatives (sensitivity.h), over a window that
// grows, so that a start that is far off is repaired before a long run can run away from it.
#pragma once

#include <optional>
#include <vector>

#include "attitude/propagation/propagator.h"
#include "attitude/recordings/recording.h"
#include "attitude/recordings/sensors.h"

namespace photorque {

struct FitOptions {
  // One standard deviation of the readings; used where the sensors' own noise is zero.
  Vec3 camera_noise_rad = Vec3(37, 37, 12) * arcsecond_rad;
  double gyro_noise_rad_s = 2e-4;
  // Shares of the recording that are fitted in turn.
  std::vector<double> windows = {0.02, 0.07, 0.25, 1.0};
  int max_iterations = 30;  // in each window
  PropagationOptions propagation{.tolerance = 1e-8};
};

struct TrajectoryFit {
  AttitudeModel model;    // with the fitted parameters
  PlatformState initial;  // fitted
  std::vector<Variable> variables;
  Eigen::MatrixXd covariance;  // of the variables, from the noise as given
  double chi2_per_sample = 0.0;
  int64_t samples = 0;  // numbers compared
  // What is left of the camera's attitudes, lab axes [rad], at these times.
  std::vector<double> residual_time_s;
  std::vector<Vec3> camera_residual_rad;
};

// A parameter to fit: with a finite sigma its value is drawn to the nominal one.
struct FreeParameter {
  size_t disturbance = 0;
  int parameter = 0;
  std::optional<double> sigma;
};

// `model` is where the fit starts; its schedule is used as it is. The first complete attitude of
// the recording (and the gyro, where there is one) starts the initial state. InputError when the
// recording has no attitude; NumericalError when the fit does not converge.
TrajectoryFit fit_trajectory(const AttitudeModel& model, const Sensors& sensors,
                             const Recording& recording,
                             const std::vector<FreeParameter>& parameters,
                             const FitOptions& options = {});

}  // namespace photorque
