// A model's prediction of an observation, and whitened residuals.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "attitude/observation/observation.h"
#include "attitude/propagation/propagator.h"
#include "inference/estimator/arrow_matrix.h"
#include "inference/estimator/parameter.h"

namespace photorque {

// Whitens the readings of one channel: converts residuals with correlated noise to independent ones
// of unit variance, in order of time. These are the normalised innovations: reading minus
// prediction from the earlier blocks, divided by its standard deviation.
//
// Noise is as in ChannelNoise: white, plus a part whose correlation decreases as exp(−t/τ) (an
// AR(1) process, sampled at the readings), times the factor of the run's profile. A block is the
// mean of its readings. Its variance and its correlation with other blocks follow in closed form,
// so that averages are whitened as exactly as readings. The recursion is that of the Kalman filter
// (Anderson & Moore, Optimal Filtering, 1979, section 5.3). It is linear in the readings, so it
// also applies to predictions and their derivatives.
class Whitening {
 public:
  // `width`: number of values in a row: a residual and its derivatives.
  Whitening(const Observation& seen, int channel, Eigen::Index width);

  // Whitens the next block of `rows` readings at `time_s`. `row` has a residual and its derivatives
  // in the channel's unit. Afterwards it is independent of all previous rows and in units of its
  // standard deviation.
  template <typename Row>
  void apply(double time_s, double rows, Row&& row) {
    const double factor = profile_.at(time_s);
    if (!coloured_) {
      row *= std::sqrt(rows) / (level_ * factor);
      return;
    }
    if (factor != 1.0) row /= factor;
    const Gain now = gain(time_s, rows);
    expected_ *= now.decay;
    row = row * now.scale - expected_;
    expected_ += now.gain * row;
    row *= now.weight;
  }

 private:
  // decay: decrease of the expectation since the last block. scale: factor of a block, so that all
  // blocks contain the same correlated process. gain: gain of the expectation from the difference.
  // weight: one over the standard deviation of the difference.
  struct Gain {
    double decay, scale, gain, weight;
  };
  Gain gain(double time_s, double rows);

  NoiseProfile profile_;
  bool coloured_ = false;
  double level_;
  double white_variance_ = 0.0, coloured_variance_ = 0.0, time_s_ = 0.0;
  double interval_s_ = 0.0;  // between the readings of a block
  double last_s_ = 0.0, variance_ = 0.0;
  Eigen::RowVectorXd expected_;
};

// Mean of n readings at intervals of `steps` = interval/τ, of a process with correlation exp(−t/τ)
// and variance one. The covariance of two means that do not overlap is reach² exp(−t/τ), where t is
// the interval between their centres. A reading with a weight n below one has more independent
// noise. Intervals count up to 20 τ/n: for means over more, `reach` is too large for the precision
// of a double, and the correlation of neighbours is below 5 %.
struct MeanOfCorrelated {
  double variance = 1.0, reach = 1.0;
};
MeanOfCorrelated mean_of_correlated(double n, double steps);

// Median interval between the readings of a channel [s]; 0 if there are none.
double reading_interval_s(const Observation& seen, int channel);

// Residuals of a block by channel (recordings/columns.h): attitude about lab x, y, z, gyro x, y, z,
// scalars; NaN for missing readings.
using WhiteRow = Eigen::Matrix<double, channel_count, 1>;

struct Prediction {
  inference::NormalSums sums;
  // Only with PredictionOptions::keep_residuals.
  std::vector<WhiteRow> residual;  // whitened: independent, in units of their standard deviation
  std::vector<WhiteRow> off;       // measured − predicted [rad, rad/s]
  std::vector<PlatformState> states;
  std::vector<Vec3> camera_offset_lab_rad;  // from the state's attitude to the camera's reading
  std::vector<Vec3> gyro_rad_s;             // readings of the gyro
  // Prediction of each scalar of the observation; zero for others.
  std::vector<Eigen::Matrix<double, scalar_count, 1>> scalars;
};

struct PredictionOptions {
  PropagationOptions propagation{.tolerance = 1e-7, .derivative_tolerance = 1e-9};
  size_t blocks = SIZE_MAX;  // only the first blocks
  bool keep_residuals = false;
  double max_chi2 = inference::infinity;  // NumericalError if χ² exceeds it
};

// Predicts the blocks of `seen` and compares them. `variables` may be empty. The attitude error is
// linearised, and the camera's delay is considered to first order. NumericalError if the model
// cannot be propagated.
Prediction predict(const Dynamics& dynamics, const PlatformState& initial, const Observation& seen,
                   const std::vector<Variable>& variables, const PredictionOptions& options = {});

}  // namespace photorque
