// Readings of noiseless instruments along a motion, and their derivatives by each variable.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "attitude/observation/observation.h"
#include "attitude/propagation/sampling.h"

namespace photorque {

// Accelerometer and magnetometer, in the order of their scalars.
using FieldRow = Eigen::Matrix<double, first_place - first_field, 1>;
// Derivatives by channel (recordings/columns.h) and variable.
using SlopeRows = Eigen::Matrix<double, channel_count, Eigen::Dynamic, Eigen::RowMajor>;

// The prediction of a model for a block, or for one of its instants.
struct ExpectedInstant {
  PlatformState state;
  Vec3 camera_offset_body = Vec3::Zero(), gyro_rad_s = Vec3::Zero();
  Vec3 gyro_mean_rad_s = Vec3::Zero();  // of a block: mean over the times of the gyro readings
  FieldRow fields = FieldRow::Zero();
  Eigen::Vector4d place = Eigen::Vector4d::Zero();  // position and velocity
};

// Expected readings at up to eight times.
struct ExpectedReadings {
  std::array<ExpectedInstant, Lanes::count> instant;
  // Derivatives with respect to each variable, except for scalars that are functions of attitude
  // and gyro.
  std::array<SlopeRows, Lanes::count> slope;
};
// `sensitivity`: null if no derivatives are needed. `scalars`: those that were read.
ExpectedReadings expected_readings(const Dynamics& dynamics, const Sensitivity* sensitivity,
                                   const Samples& samples, const Observation& seen,
                                   const std::vector<int>& scalars);

}  // namespace photorque
