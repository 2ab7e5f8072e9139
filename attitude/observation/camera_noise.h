// The noise of the camera, by the likelihood of its angles and the rates of a gyro.
#pragma once

#include <vector>

#include "attitude/observation/kinematics.h"
#include "inference/estimator/thresholds.h"

namespace photorque {

// Likelihood of the readings of an angle and its rate, by camera and gyro, under a model of noise.

// The noise model of one axis. The angle's third derivative is white noise (Wiener torque), so that
// any smooth torque is allowed, and none is preferred once `roughness` is large.
struct AngleNoise {
  ChannelNoise camera;
  Vec3 gyro_rad_s = Vec3::Zero();  // one reading about body x, y, z
  // Fraction of the gyro's variance that is correlated as exp(−t/τ), and τ.
  double gyro_coloured = 0.0, gyro_time_s = 0.0;
  double roughness = 1e-8;  // spectral density of the third derivative [rad²/s⁵]
};

// Minus twice the logarithm of the likelihood, by a Kalman filter over angle, rate, acceleration
// and the correlated noise of both.
double minus_two_log_likelihood(const KinematicSeries& series, const AngleNoise& noise);

// The normal equations of the columns of `series` against the residuals, whitened by the filter:
// matrix and right-hand side are added to.
void add_normal_equations(const KinematicSeries& series, const AngleNoise& noise,
                          Eigen::MatrixXd& matrix, Eigen::VectorXd& right);

// The camera's noise about one lab axis.

// The noise of one channel: the estimate and its significance.
struct FoundNoise {
  ChannelNoise noise;        // to be used: as stated unless something else was found
  bool level_found = false;  // differs from the stated level
  bool colour_found = false;
  double level_sigma = 0.0;   // standard error of ln level
  double time_sigma_s = 0.0;  // of the correlation time
  double gain = 0.0;  // twice the log likelihood of correlated noise over that of the best white
};

struct CameraNoise {
  FoundNoise found;
  AngleNoise axis;     // of maximum likelihood
  double value = 0.0;  // its minus two log likelihood
};

// The maximum-likelihood noise of the camera in all runs, `gyro` (the gyro's part of it) taken as
// known.
CameraNoise camera_noise(const std::vector<const KinematicSeries*>& runs,
                         const ChannelNoise& stated, const AngleNoise& gyro,
                         const Thresholds::Noise& limits);

// Whether a level that is off by a factor is one of another noise, with the standard error of the
// factor's logarithm.
bool is_off(double log_factor, double sigma, const Thresholds::Noise& limits);

}  // namespace photorque
