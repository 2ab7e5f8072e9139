// How likely an angle and its rate, as a camera and a gyro read them, are under some noise.
#pragma once

#include "attitude/noise/kinematics.h"

namespace photorque {

// What is assumed of one axis. The angle's third derivative is white noise (Wiener torque), so that
// any smooth torque is allowed, and none is preferred once `roughness` is large.
struct AngleNoise {
  ChannelNoise camera;
  Vec3 gyro_rad_s = Vec3::Zero();  // one reading about body x, y, z
  // Of the gyro's variance, the fraction that is correlated as exp(−t/τ), and τ.
  double gyro_coloured = 0.0, gyro_time_s = 0.0;
  double roughness = 1e-8;  // spectral density of the third derivative [rad²/s⁵]
};

// Minus twice the logarithm of the likelihood, by a Kalman filter over angle, rate, acceleration
// and the correlated noise of both.
double minus_two_log_likelihood(const KinematicSeries& series, const AngleNoise& noise);

// The normal equations of the columns of `series` against what is left, whitened by the filter:
// matrix and right-hand side are added to.
void add_normal_equations(const KinematicSeries& series, const AngleNoise& noise,
                          Eigen::MatrixXd& matrix, Eigen::VectorXd& right);

}  // namespace photorque
