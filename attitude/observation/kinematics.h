// Comparison of camera and gyro: residuals of both about one motion, independent of the torques.
#pragma once

#include <array>
#include <vector>

#include "attitude/observation/prediction.h"

namespace photorque {

// Residuals about one lab axis of one recording, by block. A rotation and the rate that belongs to
// it are subtracted from the readings. The residuals therefore obey d(angle)/dt = rate to first
// order, apart from noise, with the platform's deviation from that motion as the angle.
struct KinematicSeries {
  std::vector<double> time_s;
  std::vector<double> angle_rad, rate_rad_s;  // residuals of camera and gyro; NaN: no reading
  std::vector<double> rows;                   // readings in the camera's block
  // Fractions of the gyro's x, y, z in this axis: mean squares of the direction cosines.
  std::vector<Vec3> gyro_share;
  std::vector<double> gyro_rows;                   // readings in the gyro's block
  bool about_readings = false;                     // as in KinematicRun
  std::vector<char> jumps;                         // a command changed since the previous block
  double interval_s = 0.0, gyro_interval_s = 0.0;  // between readings of each instrument
  // Means over more than four correlation times no longer determine the correlation time.
  double shortest_correlation_s = 0.0;
  // Contributions of instrument errors, one column each: gyro biases (3), a linear drift of them
  // (3), scale and misalignment of the gyro (9, by rows), camera delay, growth of the delay with
  // time, and rotation of the laboratory (3), which the gyro measures and the camera does not. No
  // columns without a gyro.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> angle_by, rate_by;

  size_t blocks() const { return time_s.size(); }
};

struct KinematicRun {
  std::array<KinematicSeries, 3> axis;  // about lab x, y, z
  std::vector<Vec3> rate_body_rad_s;    // residuals of the gyro, in body axes
  // The motion is a curve through the attitudes. It hides their noise unless a gyro shows it.
  bool about_readings = false;
};

// `about` is a predicted motion near the recording, with its residuals. If they are too large for
// the linear model, or if `about` is null, the motion is a smooth curve through the attitudes.
KinematicRun kinematic_run(const Observation& seen, const Prediction* about);

// Prior standard deviations of the columns, larger than the errors of any instrument. They limit
// parameters that a recording does not determine.
Eigen::VectorXd instrument_widths();

// Index of the column of the delay's growth [s/s].
constexpr Eigen::Index clock_drift_column = 16, instrument_columns = 20;

}  // namespace photorque
