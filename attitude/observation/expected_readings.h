// What noiseless instruments read as a motion passes, and how that changes with each variable.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "attitude/observation/observation.h"
#include "attitude/propagation/sampling.h"

namespace photorque {

// Accelerometer and magnetometer, in the order of their scalars.
using FieldRow = Eigen::Matrix<double, first_place - first_field, 1>;
// By channel (readings/channels.h) and variable.
using SlopeRows = Eigen::Matrix<double, channel_count, Eigen::Dynamic, Eigen::RowMajor>;

// What a model says of a block, or of one of its instants.
struct ExpectedInstant {
  PlatformState state;
  Vec3 camera_offset_body = Vec3::Zero(), gyro_rad_s = Vec3::Zero();
  Vec3 gyro_mean_rad_s = Vec3::Zero();  // of a block: over the gyro's own times
  FieldRow fields = FieldRow::Zero();
  Eigen::Vector4d place = Eigen::Vector4d::Zero();  // and velocity
};

// At up to eight instants.
class ExpectedReadings {
 public:
  virtual ~ExpectedReadings() = default;

  virtual ExpectedInstant at(int lane) = 0;
  // What changes with each variable, but for scalars that follow from attitude and gyro. Nothing
  // without a sensitivity.
  virtual void fill_slopes(int lane, const ExpectedInstant& instant, SlopeRows& slope) const = 0;
};

// `sensitivity`: null where no slopes are asked for. `scalars`: those that were read. Keeps a
// reference to the samples.
std::unique_ptr<ExpectedReadings> expected_readings(const Dynamics& dynamics,
                                                    const Sensitivity* sensitivity,
                                                    const Samples& samples, const Observation& seen,
                                                    const std::vector<int>& scalars);

}  // namespace photorque
