// What a model predicts for an observation, beside what was seen.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "attitude/observation/observation.h"
#include "attitude/propagation/propagator.h"
#include "inference/estimator/arrow_matrix.h"
#include "inference/estimator/parameter.h"

namespace photorque {

// The residuals of a block by channel (readings/channels.h): attitude about lab x, y, z, gyro x, y,
// z, scalars; NaN where nothing was measured.
using WhiteRow = Eigen::Matrix<double, channel_count, 1>;

struct Prediction {
  inference::NormalSums sums;
  // Filled on request.
  std::vector<WhiteRow> residual;  // whitened: independent, in units of their standard deviation
  std::vector<WhiteRow> off;       // measured − predicted [rad, rad/s]
  std::vector<PlatformState> states;
  std::vector<Vec3> camera_offset_lab_rad;  // from the state's attitude to what the camera reports
  std::vector<Vec3> gyro_rad_s;             // what the gyro reads
  // What each scalar that the observation has reads; zero for others.
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
