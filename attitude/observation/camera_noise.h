// Noise of the camera by maximum likelihood, from its angles and the rates of a gyro.
#pragma once

#include <vector>

#include "attitude/observation/kinematics.h"
#include "inference/estimator/thresholds.h"

namespace photorque {

// Noise model of one axis. The third derivative of the angle is white noise (Wiener torque). This
// allows any smooth torque; with a large `roughness` no torque is preferred.
struct AngleNoise {
  ChannelNoise camera;
  Vec3 gyro_rad_s = Vec3::Zero();  // of one reading about body x, y, z
  // Fraction of the gyro's variance that is correlated as exp(−t/τ), and τ.
  double gyro_coloured = 0.0, gyro_time_s = 0.0;
  double roughness = 1e-8;  // spectral density of the third derivative [rad²/s⁵]
};

// Minus twice the logarithm of the likelihood of an angle and its rate, by a Kalman filter. Its
// states are angle, rate, acceleration and the correlated noise of both instruments.
double minus_two_log_likelihood(const KinematicSeries& series, const AngleNoise& noise);

// Adds the normal equations of the columns of `series` and its residuals, whitened by the filter,
// to `matrix` and `right`.
void add_normal_equations(const KinematicSeries& series, const AngleNoise& noise,
                          Eigen::MatrixXd& matrix, Eigen::VectorXd& right);

// The noise of one channel: the estimate and its significance.
struct FoundNoise {
  ChannelNoise noise;        // the noise to use: as stated unless another was found
  bool level_found = false;  // differs from the stated level
  bool colour_found = false;
  double level_sigma = 0.0;   // standard error of ln level
  double time_sigma_s = 0.0;  // standard error of the correlation time
  double gain = 0.0;          // twice the log-likelihood gain of correlated over white noise
};

struct CameraNoise {
  FoundNoise found;
  AngleNoise axis;     // of maximum likelihood
  double value = 0.0;  // minus twice the log-likelihood of `axis`
};

// The maximum-likelihood noise of the camera about one lab axis in all runs. The gyro's part of
// `gyro` is given and not fitted.
CameraNoise camera_noise(const std::vector<const KinematicSeries*>& runs,
                         const ChannelNoise& stated, const AngleNoise& gyro,
                         const Thresholds::Noise& limits);

// Whether a level differs from the stated one by a significant factor. `sigma` is the standard
// error of `log_factor`.
bool is_off(double log_factor, double sigma, const Thresholds::Noise& limits);

}  // namespace photorque
