// Multiplicative extended Kalman filter and fixed-interval smoother over readings.
//
// Filter: F. Markley, J. Crassidis, Fundamentals of Spacecraft Attitude Determination and Control
// (2014), sec. 6.2; covariance updates in Joseph's form. Smoother: H. Rauch, F. Tung, C. Striebel,
// AIAA J. 3 (1965) 1445, with differences of attitudes as rotation vectors.
#pragma once

#include <functional>
#include <vector>

#include "attitude/filtering/motion_model.h"

namespace photorque {

// Attitude and rate at a row.
struct AttitudeEstimate {
  double time_s = 0.0;
  Quat lab_from_body = Quat::Identity();
  Vec3 rate_body_rad_s = Vec3::Zero();
  Vec3 inertial_rate_rad_s = Vec3::Zero();  // reading of a perfect gyro
  // Covariance of rotation vector and rate, body axes.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();

  double attitude_sigma_rad() const;  // root of the sum over the three axes
  double rate_sigma_rad_s() const;
};

// Normalised innovations squared of one kind of reading: their sum, and of how many numbers.
struct InnovationSum {
  double chi2 = 0.0;
  double numbers = 0.0;
  double per_number() const { return numbers > 0.0 ? chi2 / numbers : 0.0; }
};

struct Estimation {
  std::vector<AttitudeEstimate> filtered, smoothed;  // by row; the latter empty if not asked for
  InnovationSum attitude, gyro, yaw;
  double log_likelihood = 0.0;  // of the readings after the first attitude
  // Parameters at the end, with their standard deviations, and their initial values.
  std::vector<std::string> parameter_names;
  VecX parameters, sigma, prior_mean, prior_sigma;
};

struct EstimationOptions {
  bool smooths = true;
  size_t max_readings = SIZE_MAX;  // only so many, from the first
  // Covariance of the initial attitude, if the attitude is never measured; otherwise the first
  // reading initialises it.
  Mat3 unread_attitude_rad2 = Mat3::Zero();
  std::function<void(double)> progress = {};
};

// Runs the filter over the readings and the smoother back over them. Rows before the first attitude
// have its estimate. The smoother stores a checkpoint every few hundred readings and recomputes the
// steps between, so that only the estimates need memory.
Estimation estimate_attitude(const MotionModel& model, const Readings& readings,
                             const EstimationOptions& options = {});

// The rate's random walk of maximum likelihood, to an eighth of a decade from 1e-14 to 100 rad/s
// per √s; over the first `max_readings`.
double max_likelihood_rate_walk(const AttitudeModel& model, const Sensors& sensors,
                                FilterSettings settings, const Readings& readings,
                                size_t max_readings);

}  // namespace photorque
