// The model of motion and instruments that a filter uses between readings.
//
// The error state consists of the rotation vector from the estimated to the true attitude in body
// axes, the rate, the extra states of the disturbances, and every parameter with a sigma. All
// derivatives are exact derivatives of the laws (Dynamics).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "attitude/filtering/readings.h"
#include "attitude/model/dynamics.h"

namespace photorque {

using MatX = Eigen::MatrixXd;
using VecX = Eigen::VectorXd;

// The model of the motion between readings.
enum class Motion {
  gyro_drives,   // gyro readings give the rate; in their gaps, a random walk
  rate_walks,    // random walk of the rate
  disturbances,  // Euler's equations with the modelled torques and an unknown torque, which causes
                 // a random walk of the rate
};

struct FilterSettings {
  Motion motion = Motion::disturbances;
  // Random walk of the rate, body axes: the standard deviation that the square root of 1 s adds.
  double rate_walk_rad_s_rts = 1e-4;
  double rate_sigma_rad_s = 1.0;  // before the first reading
  bool uses_attitude = true;      // in addition to the first attitude
  bool uses_gyro = true;
};

struct FilterState {
  PlatformState mean;
  VecX parameters;  // those of the model with a sigma
  MatX covariance;
  // The dynamics with the parameters `reference`.
  std::shared_ptr<const Dynamics> dynamics;
  VecX reference;
};

struct Transition {
  MatX phi;         // transition matrix of the error state
  MatX covariance;  // of the noise during the transition
};

// A measurement: residual (reading − prediction), its derivative with respect to the error state,
// and the covariance of its noise.
struct Measurement {
  VecX residual;
  MatX derivative;
  MatX noise;
};

struct Observation;

class MotionModel {
 public:
  // The torques are used only if `settings` selects the model with disturbances. A gyro bias is
  // added if the model has none. The schedule is that of the recording.
  MotionModel(const AttitudeModel& model, const Sensors& sensors, const FilterSettings& settings,
              const Schedule& schedule);

  static constexpr int attitude = 0, rate = 3, extra = 6;
  int size() const { return size_; }
  int first_parameter() const { return extra + extras_; }
  // Names of the parameters, for example "gyro_bias.bias_rad_s[0]".
  const std::vector<std::string>& parameter_names() const { return names_; }
  const VecX& prior_mean() const { return prior_mean_; }
  const VecX& prior_sigma() const { return prior_sigma_; }
  const FilterSettings& settings() const { return settings_; }

  // The initial state, from an attitude with the covariance `attitude_lab_rad2`.
  FilterState start(double time_s, const Quat& lab_from_body, const Mat3& attitude_lab_rad2) const;
  // After an unknown kick: rate and attitude become uncertain again.
  void reset_after_kick(FilterState& state) const;

  // Propagates the state to a later time. `gyro_rad_s` is the reading there. It replaces the rate
  // if the motion model uses the gyro and all three axes were read. NumericalError if more than
  // 200,000 steps are necessary.
  Transition advance(FilterState& state, double time_s, const Vec3& gyro_rad_s) const;
  // InputError if the motion between two rows is too fast for a comparison: if 20 rows, the fewest
  // of a recording, need more steps than advance() permits between two readings. The motion is the
  // oscillation by the torques of `model` at the first attitude and, if attitudes are read, the
  // recorded rate. Rows of slow motion may be months apart. The usual cause is a wrong unit of the
  // time.
  static void refuse_rows_far_apart(const Observation& seen, const AttitudeModel& model);

  // Measurements of attitude, rate and yaw at a state.
  Measurement of_attitude(const FilterState& state, const Quat& lab_from_body,
                          const std::array<bool, 3>& sees_axis) const;
  Measurement of_gyro(const FilterState& state, const Vec3& gyro_rad_s) const;
  Measurement of_yaw(const FilterState& state, double yaw_rad) const;
  // Adds an error to an estimate. The dynamics are rebuilt if parameters have changed much.
  void add(FilterState& state, const VecX& error) const;
  // The error state that add() adds to `from` to give `to`.
  VecX difference(const FilterState& to, const FilterState& from) const;

  // Body rate relative to the inertial frame, body axes: the reading of a perfect gyro.
  Vec3 inertial_rate_rad_s(const FilterState& state) const;
  double camera_delay_s() const;

 private:
  struct Prediction {
    Vec3 gyro_rad_s;
    Vec3 camera_error_rad;
    double camera_delay_s;
    MatX derivative;  // Dynamics::reading_count rows
  };
  // Derivatives with respect to the error state: of the rates (rows are the components of Dynamics)
  // or of the readings (Dynamics::reading_count rows).
  MatX derivatives_of(const FilterState& state, bool of_readings) const;
  Prediction predicted_readings(const FilterState& state) const;
  MatX rate_matrix(const FilterState& state) const;
  double step_length_s(const FilterState& state, double wanted_s) const;
  void step(FilterState& state, double length_s) const;
  Mat3 free_axes() const;
  void add_noise(MatX& covariance, double length_s) const;
  void add_parameter_walks(MatX& covariance, double length_s) const;
  void drive(FilterState& state, double length_s, const Vec3& gyro_rad_s, Transition& whole) const;
  VecX right_hand_side(const FilterState& state, const VecX& y, double time_s) const;
  void refresh(FilterState& state) const;
  std::shared_ptr<const Dynamics> dynamics_with(const VecX& parameters) const;

  AttitudeModel model_;
  Sensors sensors_;
  FilterSettings settings_;
  int extras_ = 0, size_ = 0;
  struct Place {
    size_t disturbance;
    size_t parameter;
    double walk_rts = 0.0;  // random walk of the parameter
  };
  std::vector<Place> places_;
  std::vector<std::string> names_;
  VecX prior_mean_, prior_sigma_;
};

}  // namespace photorque
