// What the instruments read, as a filter expects it: the readings' part of MotionModel.
#include <cmath>

#include "attitude/disturbances/kind.h"
#include "attitude/filtering/motion_model.h"
#include "core/transform.h"

namespace photorque {
namespace {

std::array<ZeroOrderHold, Lanes::count> in_all_lanes(const ZeroOrderHold& held) {
  std::array<ZeroOrderHold, Lanes::count> all;
  all.fill(held);
  return all;
}

std::vector<Lanes> in_lanes(const std::vector<double>& y) {
  return {y.begin(), y.end()};
}

// ∂q/∂θ for q ⊗ exp(θ): components w, x, y, z.
Eigen::Matrix<double, 4, 3> quaternion_by_turn(const Quat& q) {
  Eigen::Matrix<double, 4, 3> g;
  g << -q.x(), -q.y(), -q.z(), q.w(), -q.z(), q.y(), q.z(), q.w(), -q.x(), -q.y(), q.x(), q.w();
  return 0.5 * g;
}

}  // namespace

MotionModel::Derivatives MotionModel::derivatives_of(const FilterState& state,
                                                     bool of_readings) const {
  const Dynamics& dynamics = *state.dynamics;
  const std::vector<Lanes> y = in_lanes(to_vector(state.mean));
  const ZeroOrderHold held = model_.schedule.at(state.mean.time_s);
  const int components = dynamics.size();
  const int rows = of_readings ? Dynamics::reading_count : components;
  // Attitude and rate, extra states, parameters.
  const int variables = component::charge + extras_ + static_cast<int>(places_.size());
  MatX by_variable(rows, variables);
  std::vector<Lanes> out(static_cast<size_t>(rows) * DualLanes::block);
  Dynamics::Workspace room;
  for (int first = 0; first < variables; first += DualLanes::block) {
    Dynamics::Block block;
    block.state.fill(-1);
    block.parameter.fill(-1);
    const int count = std::min(DualLanes::block, variables - first);
    for (int k = 0; k < count; ++k) {
      const auto lane = static_cast<size_t>(k);
      const int v = first + k, own = v - component::charge;
      if (own < 0) {
        block.state[lane] = v;
      } else if (own < extras_) {
        block.state[lane] = component::extra + own;
      } else {
        const Place& place = places_[static_cast<size_t>(own - extras_)];
        block.parameter[lane] =
            dynamics.first_parameter(place.disturbance) + static_cast<int>(place.parameter);
      }
    }
    if (of_readings) {
      dynamics.reading_derivatives(state.mean.time_s, in_all_lanes(held), y.data(), block,
                                   out.data(), room);
    } else {
      dynamics.derivatives(state.mean.time_s, held, y.data(), block, out.data(), room);
    }
    for (int r = 0; r < rows; ++r) {
      for (int k = 0; k < count; ++k) {
        by_variable(r, first + k) =
            out[static_cast<size_t>(r) * DualLanes::block + static_cast<size_t>(k)][0];
      }
    }
  }
  MatX by_error(rows, size_);
  by_error.leftCols<3>() = by_variable.leftCols<4>() * quaternion_by_turn(state.mean.lab_from_body);
  by_error.rightCols(size_ - 3) = by_variable.rightCols(size_ - 3);
  if (of_readings) return {{}, by_error};
  return {by_error, {}};
}

MotionModel::Prediction MotionModel::predicted_readings(const FilterState& state) const {
  const std::vector<Lanes> y = in_lanes(to_vector(state.mean));
  const auto held = in_all_lanes(model_.schedule.at(state.mean.time_s));
  const Dynamics::Instants now = state.dynamics->at(state.mean.time_s, held, y.data());
  Prediction prediction;
  for (int k = 0; k < 3; ++k) {
    prediction.gyro_rad_s[k] = now.gyro_rad_s[k][0];
    prediction.camera_error_rad[k] = now.camera_error_rad[k][0];
  }
  prediction.camera_delay_s = now.camera_delay_s[0];
  prediction.derivative = derivatives_of(state, true).readings;
  const VecX moved = prediction.derivative.rightCols(state.parameters.size()) *
                     (state.parameters - state.reference);
  prediction.gyro_rad_s += moved.segment<3>(0);
  prediction.camera_error_rad += moved.segment<3>(3);
  return prediction;
}

Measurement MotionModel::of_attitude(const FilterState& state, const Quat& lab_from_body,
                                     const std::array<bool, 3>& sees_axis) const {
  const Prediction reading = predicted_readings(state);
  const Quat mean = state.mean.lab_from_body;
  const Quat error = turn_by(reading.camera_error_rad);
  // In lab axes, in which the noise is stated and axes are seen or not.
  const Vec3 residual_rad = mean * turn_vector((mean * error).conjugate() * lab_from_body);
  MatX derivative = MatX::Zero(3, size_);
  derivative.leftCols<3>() = error.conjugate().toRotationMatrix();
  derivative += reading.derivative.middleRows<3>(3);
  // A later reading shows where the platform was still earlier.
  derivative -= state.mean.rate_body_rad_s * reading.derivative.row(6);
  derivative = mean.toRotationMatrix() * derivative;
  Sensors::Camera camera;
  if (sensors_.camera) camera = *sensors_.camera;
  const auto noise = camera_covariance_lab_rad2(camera, mean, state.mean.rate_body_rad_s);
  Measurement all{residual_rad, derivative,
                  noise ? *noise : Mat3(camera.noise_rad.cwiseAbs2().asDiagonal())};
  std::vector<int> axes;
  for (int k = 0; k < 3; ++k) {
    if (sees_axis[static_cast<size_t>(k)]) axes.push_back(k);
  }
  return {all.residual(axes), all.derivative(axes, Eigen::all), all.noise(axes, axes)};
}

Measurement MotionModel::of_gyro(const FilterState& state, const Vec3& gyro_rad_s) const {
  const Prediction reading = predicted_readings(state);
  std::vector<int> axes;
  for (int k = 0; k < 3; ++k) {
    if (std::isfinite(gyro_rad_s[k])) axes.push_back(k);
  }
  const VecX residual = gyro_rad_s - reading.gyro_rad_s;
  const MatX derivative = reading.derivative.topRows<3>();
  const double noise_rad_s = sensors_.gyro ? sensors_.gyro->noise_rad_s : 0.0;
  const auto count = static_cast<Eigen::Index>(axes.size());
  return {residual(axes), derivative(axes, Eigen::all),
          std::pow(noise_rad_s, 2) * MatX::Identity(count, count)};
}

Measurement MotionModel::of_heading(const FilterState& state, double heading) const {
  const Vec3 ahead = state.mean.lab_from_body * Vec3::UnitX();
  const Mat3 by_turn = -state.mean.lab_from_body.toRotationMatrix() * skew(Vec3::UnitX());
  MatX derivative = MatX::Zero(1, size_);
  derivative.leftCols<3>() =
      (ahead.x() * by_turn.row(1) - ahead.y() * by_turn.row(0)) / ahead.head<2>().squaredNorm();
  const double difference_rad = std::remainder(heading - heading_rad(state.mean), 2.0 * pi);
  const double step_rad = sensors_.encoder ? sensors_.encoder->resolution_rad : 1e-4;
  // Even within a step.
  return {VecX::Constant(1, difference_rad), derivative,
          MatX::Constant(1, 1, step_rad * step_rad / 12.0)};
}

Vec3 MotionModel::inertial_rate_rad_s(const FilterState& state) const {
  AttitudeModel model = state.dynamics->model();
  std::erase_if(model.disturbances,
                [](const Disturbance& d) { return d.stage == Stage::measurement; });
  const Dynamics dynamics(model);
  PlatformState mean = state.mean;
  mean.extra.resize(static_cast<size_t>(dynamics.size() - component::extra));
  const std::vector<Lanes> y = in_lanes(to_vector(mean));
  const auto held = in_all_lanes(model_.schedule.at(mean.time_s));
  const Dynamics::Instants now = dynamics.at(mean.time_s, held, y.data());
  return {now.gyro_rad_s[0][0], now.gyro_rad_s[1][0], now.gyro_rad_s[2][0]};
}

double MotionModel::camera_delay_s() const {
  const FilterState state = start(0.0, Quat::Identity(), Mat3::Identity());
  return predicted_readings(state).camera_delay_s;
}

}  // namespace photorque
