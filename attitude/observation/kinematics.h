// Camera against gyro: residuals of both about one motion, under any torque.
#pragma once

#include <array>
#include <vector>

#include "attitude/observation/prediction.h"

namespace photorque {

// About one lab axis along one recording, by block. A rotation and a rate that belong together are
// taken from the readings, so that the residual obeys d(angle)/dt = rate to first order: the
// platform's own deviation from that motion, and noise.
struct KinematicSeries {
  std::vector<double> time_s;
  std::vector<double> angle_rad, rate_rad_s;  // left of camera and gyro; NaN: no reading
  std::vector<double> rows;                   // readings in the camera's block
  // Fractions of the gyro's x, y, z in this axis: mean squares of the direction cosines.
  std::vector<Vec3> gyro_share;
  std::vector<double> gyro_rows;                   // readings in the gyro's block
  bool about_readings = false;                     // as in KinematicRun
  std::vector<char> jumps;                         // a command changed since the block before
  double interval_s = 0.0, gyro_interval_s = 0.0;  // between the readings of each
  // Means over more than four correlation times no longer determine the correlation time.
  double shortest_correlation_s = 0.0;
  // Contributions of instrument errors: of the gyro biases (3), a linear drift of them (3), scale
  // and misalignment (9, by rows), of the camera its delay and how that grows with time; then the
  // turning of the laboratory itself (3), which the gyro reads and the camera does not. No columns
  // without a gyro.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> angle_by, rate_by;

  size_t blocks() const { return time_s.size(); }
};

struct KinematicRun {
  std::array<KinematicSeries, 3> axis;  // about lab x, y, z
  std::vector<Vec3> rate_body_rad_s;    // left of the gyro, in body axes
  // The motion is a curve through the attitudes, which hides their noise unless a gyro shows it.
  bool about_readings = false;
};

// `about` is a motion near the recording's, with its residuals; where those are beyond the linear,
// or there is none (null), the motion is a smooth curve through the attitudes.
KinematicRun kinematic_run(const Observation& seen, const Prediction* about);

// Standard deviations, for such columns, beyond what any instrument does: they keep what a
// recording does not show from running away. In the order of the columns.
Eigen::VectorXd instrument_widths();

// Index of the column of the delay's growth [s/s].
constexpr Eigen::Index clock_drift_column = 16, instrument_columns = 20;

}  // namespace photorque
