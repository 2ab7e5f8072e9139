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

  double attitude_sigma_rad() const;  // root of the sum of the variances of the three axes
  double rate_sigma_rad_s() const;
};

// Sum of the normalised innovations squared of one kind of reading, and their number.
struct InnovationSum {
  double chi2 = 0.0;
  double numbers = 0.0;
  double per_number() const { return numbers > 0.0 ? chi2 / numbers : 0.0; }
};

struct Estimation {
  std::vector<AttitudeEstimate> filtered, smoothed;  // by row; `smoothed` may be empty
  InnovationSum attitude, gyro, yaw;
  double log_likelihood = 0.0;  // of the readings after the first attitude
  // Parameters at the end with their standard deviations, and their priors.
  std::vector<std::string> parameter_names;
  VecX parameters, sigma, prior_mean, prior_sigma;
};

struct EstimationOptions {
  bool smooths = true;
  size_t max_readings = SIZE_MAX;  // only the first readings
  // Covariance of the initial attitude about lab axes if no attitude is measured. Otherwise the
  // first reading initialises the attitude.
  Mat3 unread_attitude_rad2 = Mat3::Zero();
  std::function<void(double)> progress = {};
};

// Runs the filter forward over the readings and the smoother backward. Rows before the first
// attitude get its estimate. The smoother stores a checkpoint every few hundred readings and
// recomputes the steps between them, so that only the estimates need memory.
Estimation estimate_attitude(const MotionModel& model, const Readings& readings,
                             const EstimationOptions& options = {});

// Maximum-likelihood random walk of the rate [rad/s per √s], to an eighth of a decade from 1e-14 to
// 100, from the first `max_readings` readings.
double max_likelihood_rate_walk(const AttitudeModel& model, const Sensors& sensors,
                                FilterSettings settings, const Readings& readings,
                                size_t max_readings);

}  // namespace photorque
