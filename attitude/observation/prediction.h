// A model's prediction of an observation, and whitened residuals.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "attitude/observation/observation.h"
#include "attitude/propagation/propagator.h"
#include "inference/estimator/arrow_matrix.h"
#include "inference/estimator/parameter.h"

namespace photorque {

// Readings with correlated noise turned into independent ones of unit variance.

// Normalised innovations of one channel, in order of time: reading minus prediction from the
// earlier blocks, divided by its standard deviation. Noise is white, plus a part whose correlation
// falls off as exp(−t/τ) (an AR(1) process, sampled whenever there is a reading), as ChannelNoise
// says, times the factor of the run's profile. A block is the mean of its readings: its variance
// and its correlation with others are those of such means in closed form, so that averages are
// whitened as exactly as readings. The recursion is that of the Kalman filter (Anderson & Moore,
// Optimal Filtering, 1979, section 5.3), linear in the readings, so that predictions and their
// derivatives go the same way.
class Whitening {
 public:
  // `width`: how many numbers go through at once: a residual and its slopes.
  Whitening(const Observation& seen, int channel, Eigen::Index width);

  // The next block of `rows` readings at `time_s`: a row of residual and slopes in the channel's
  // unit becomes independent of all before, in units of its standard deviation.
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
  // By what the expectation shrinks since the last block; by what a block is multiplied so that all
  // share one correlated process; the gain of the expectation from the difference; one over the
  // standard deviation of that.
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

// The mean of n readings `steps` = interval/τ apart, of a process whose correlation is exp(−t/τ)
// and whose variance is one. The covariance of two means that do not overlap is reach² exp(−t/τ), t
// between their middles.
struct MeanOfCorrelated {
  double variance = 1.0, reach = 1.0;
};
MeanOfCorrelated mean_of_correlated(double n, double steps);

// Between the readings of a channel within a block [s]; 0 where it has none.
double reading_interval_s(const Observation& seen, int channel);

// The residuals of a block by channel (recordings/columns.h): attitude about lab x, y, z, gyro x,
// y, z, scalars; NaN where nothing was measured.
using WhiteRow = Eigen::Matrix<double, channel_count, 1>;

struct Prediction {
  inference::NormalSums sums;
  // Filled on request.
  std::vector<WhiteRow> residual;  // whitened: independent, in units of their standard deviation
  std::vector<WhiteRow> off;       // measured − predicted [rad, rad/s]
  std::vector<PlatformState> states;
  std::vector<Vec3> camera_offset_lab_rad;  // from the state's attitude to the camera's reading
  std::vector<Vec3> gyro_rad_s;             // readings of the gyro
  // The reading of each scalar of the observation; zero for others.
  std::vector<Eigen::Matrix<double, scalar_count, 1>> scalars;
};

struct PredictionOptions {
  PropagationOptions propagation{.tolerance = 1e-7, .derivative_tolerance = 1e-9};
  size_t blocks = SIZE_MAX;  // only the first of them
  bool keep_residuals = false;
  double max_chi2 = inference::infinity;  // beyond it the rest is not propagated
};

// `variables` may be empty. Residuals are taken at the linearised attitude error; the camera's
// delay counts to first order. Throws NumericalError when the model cannot be propagated.
Prediction predict(const Dynamics& dynamics, const PlatformState& initial, const Observation& seen,
                   const std::vector<Variable>& variables, const PredictionOptions& options = {});

}  // namespace photorque
