#include "attitude/filtering/motion_model.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "attitude/disturbances/kind.h"
#include "attitude/observation/blocks.h"
#include "core/errors.h"
#include "core/text/format.h"
#include "core/text/parse.h"
#include "core/transform.h"

namespace photorque {

namespace {

// Prior sigma of a gyro bias if the experiment states none.
constexpr double usual_bias_rad_s = 5e-3;
// Steps of this length are always sufficient, for oscillations of several periods per second too.
constexpr double short_step_s = 0.05;
// A step relative to the shortest time scale of the motion.
constexpr double part_of_time_scale = 0.1;
// Limit between two readings: more steps would take a minute, for a useless prediction.
constexpr double most_steps = 200000.0;
// Rows that share these steps: the fewest readings of a recording that is compared with a model.
constexpr double fewest_rows = 20.0;

bool is_of_gyro(const Disturbance& disturbance) {
  const DisturbanceKind* kind = find_kind(disturbance.kind);
  return kind != nullptr && kind->instrument == "gyro";
}

// Whether a disturbance affects only instruments, or only the difference of gyro and body rate.
bool is_of_instruments(const Disturbance& disturbance) {
  const DisturbanceKind* kind = find_kind(disturbance.kind);
  return disturbance.stage == Stage::measurement || disturbance.kind == "earth_rotation" ||
         (kind != nullptr && !kind->instrument.empty());
}

// Angular frequency of the fastest oscillation under the torques, or the rate of a growth.
double oscillation_1_s(const MatX& rate_matrix) {
  return std::sqrt(rate_matrix.block<3, 3>(MotionModel::rate, MotionModel::attitude).norm());
}

}  // namespace

MotionModel::MotionModel(const AttitudeModel& model, const Sensors& sensors,
                         const FilterSettings& settings, const Schedule& schedule)
    : model_(model), sensors_(sensors), settings_(settings) {
  model_.schedule = schedule;
  model_.schedule.command_delay_s = command_delay_s(model.disturbances);
  if (settings.motion != Motion::disturbances) {
    std::erase_if(model_.disturbances, [](const Disturbance& d) { return !is_of_instruments(d); });
  }
  const auto has_bias = std::ranges::any_of(
      model_.disturbances, [](const Disturbance& d) { return d.kind == "gyro_bias"; });
  if (settings.uses_gyro && !has_bias) {
    model_.disturbances.push_back(make_disturbance_of("gyro_bias", {{"bias_rad_s", {0, 0, 0}}},
                                                      {model_.platform, model_.environment}));
    for (Parameter& p : model_.disturbances.back().parameters) {
      const bool turns = !model_.platform.turns_about_one_axis() ||
                         std::abs(model_.platform.axis[p.component]) > 0.5;
      p.sigma = turns ? usual_bias_rad_s : 0.0;
    }
  }
  const double drift = sensors.gyro ? sensors.gyro->bias_drift_rad_s_1_s : 0.0;
  std::vector<double> mean, sigma;
  for (size_t d = 0; d < model_.disturbances.size(); ++d) {
    const Disturbance& disturbance = model_.disturbances[d];
    extras_ += static_cast<int>(disturbance.states.size());
    const bool drifts = disturbance.kind == "gyro_bias" && drift > 0.0;
    if (!settings.uses_gyro && is_of_gyro(disturbance)) continue;
    for (size_t p = 0; p < disturbance.parameters.size(); ++p) {
      const Parameter& parameter = disturbance.parameters[p];
      if (!(parameter.sigma > 0.0) && !drifts) continue;
      places_.push_back({d, p, drifts ? drift : 0.0});
      std::string name = disturbance.kind + "." + parameter.key;
      if (parameter.component >= 0) name += "[" + std::to_string(parameter.component) + "]";
      names_.push_back(name);
      mean.push_back(parameter.value);
      sigma.push_back(parameter.sigma);
    }
  }
  prior_mean_ = Eigen::Map<VecX>(mean.data(), static_cast<Eigen::Index>(mean.size()));
  prior_sigma_ = Eigen::Map<VecX>(sigma.data(), static_cast<Eigen::Index>(sigma.size()));
  size_ = extra + extras_ + static_cast<int>(places_.size());
}

std::shared_ptr<const Dynamics> MotionModel::dynamics_with(const VecX& parameters) const {
  AttitudeModel model = model_;
  for (size_t i = 0; i < places_.size(); ++i) {
    model.disturbances[places_[i].disturbance].parameters[places_[i].parameter].value =
        parameters[static_cast<Eigen::Index>(i)];
  }
  return std::make_shared<const Dynamics>(std::move(model));
}

FilterState MotionModel::start(double time_s, const Quat& lab_from_body,
                               const Mat3& attitude_lab_rad2) const {
  FilterState state;
  state.parameters = state.reference = prior_mean_;
  state.dynamics = dynamics_with(prior_mean_);
  state.mean = state.dynamics->initial_state();
  state.mean.time_s = time_s;
  state.mean.lab_from_body = lab_from_body;
  state.covariance = MatX::Zero(size_, size_);
  const Mat3 c = lab_from_body.toRotationMatrix();
  state.covariance.topLeftCorner<3, 3>() = c.transpose() * attitude_lab_rad2 * c;
  state.covariance.block<3, 3>(rate, rate) = std::pow(settings_.rate_sigma_rad_s, 2) * free_axes();
  if (model_.platform.turns_about_one_axis()) {
    const double about_rad2 = model_.platform.axis.dot(attitude_lab_rad2 * model_.platform.axis);
    state.covariance.topLeftCorner<3, 3>() = about_rad2 * free_axes();
  }
  // Extra states start as in the model: at rest relative to the platform.
  for (Eigen::Index i = 0; i < prior_sigma_.size(); ++i) {
    const Eigen::Index at = first_parameter() + i;
    state.covariance(at, at) = std::pow(prior_sigma_[i], 2);
  }
  return state;
}

void MotionModel::reset_after_kick(FilterState& state) const {
  state.covariance.topRows(rate + 3).setZero();
  state.covariance.leftCols(rate + 3).setZero();
  state.covariance.topLeftCorner<3, 3>() = free_axes();
  state.covariance.block<3, 3>(rate, rate) = std::pow(settings_.rate_sigma_rad_s, 2) * free_axes();
}

// Projection onto the axes about which the platform can turn.
Mat3 MotionModel::free_axes() const {
  if (!model_.platform.turns_about_one_axis()) return Mat3::Identity();
  return model_.platform.axis * model_.platform.axis.transpose();
}

void MotionModel::refresh(FilterState& state) const {
  // Largest change of a parameter, relative to its sigma, without new dynamics.
  constexpr double near = 0.05;
  for (Eigen::Index i = 0; i < state.parameters.size(); ++i) {
    const Eigen::Index at = first_parameter() + i;
    const double sigma = std::sqrt(state.covariance(at, at));
    if (std::abs(state.parameters[i] - state.reference[i]) > near * sigma) {
      state.dynamics = dynamics_with(state.parameters);
      state.reference = state.parameters;
      return;
    }
  }
}

// Derivative of the rate of the error state with respect to the error state.
MatX MotionModel::rate_matrix(const FilterState& state) const {
  MatX a = MatX::Zero(size_, size_);
  a.topLeftCorner<3, 3>() = -skew(state.mean.rate_body_rad_s);
  a.block<3, 3>(attitude, rate).setIdentity();
  if (settings_.motion != Motion::disturbances) return a;
  const MatX rates = derivatives_of(state, false);
  a.middleRows<3>(rate) = rates.middleRows<3>(component::rate);
  a.middleRows(extra, extras_) = rates.middleRows(component::extra, extras_);
  return a;
}

VecX MotionModel::right_hand_side(const FilterState& state, const VecX& y, double time_s) const {
  const std::vector<Lanes> lanes(y.begin(), y.end());
  std::vector<Lanes> rates(lanes.size());
  state.dynamics->rates(time_s, model_.schedule.at(time_s), lanes.data(), rates.data());
  VecX out(y.size());
  for (Eigen::Index i = 0; i < y.size(); ++i) out[i] = rates[static_cast<size_t>(i)][0];
  return out;
}

// Step length [s]: a fraction of the shortest time scale of rotation, oscillation and damping.
double MotionModel::step_length_s(const FilterState& state, double wanted_s) const {
  if (wanted_s <= short_step_s || extras_ > 0) return short_step_s;
  double fastest_1_s = state.mean.rate_body_rad_s.norm();
  if (settings_.motion == Motion::disturbances) {
    const MatX a = rate_matrix(state);
    fastest_1_s = std::max({fastest_1_s, oscillation_1_s(a), a.block<3, 3>(rate, rate).norm()});
    // Laws that depend on time alone do not contribute to the derivatives.
    constexpr double longest_s = 60.0;
    wanted_s = std::min(wanted_s, longest_s);
  }
  return std::max(short_step_s,
                  std::min(wanted_s, part_of_time_scale / std::max(fastest_1_s, 1e-12)));
}

// One step of the mean: by the laws with the fourth-order Runge–Kutta method, or at a constant
// rate.
void MotionModel::step(FilterState& state, double length_s) const {
  PlatformState& mean = state.mean;
  if (settings_.motion != Motion::disturbances) {
    mean.lab_from_body =
        (mean.lab_from_body * turn_by(length_s * mean.rate_body_rad_s)).normalized();
    mean.time_s += length_s;
    return;
  }
  const std::vector<double> start = to_vector(mean);
  const VecX y = Eigen::Map<const VecX>(start.data(), static_cast<Eigen::Index>(start.size()));
  const double t_s = mean.time_s, h = length_s;
  const VecX k1 = right_hand_side(state, y, t_s);
  const VecX k2 = right_hand_side(state, y + 0.5 * h * k1, t_s + 0.5 * h);
  const VecX k3 = right_hand_side(state, y + 0.5 * h * k2, t_s + 0.5 * h);
  const VecX k4 = right_hand_side(state, y + h * k3, t_s + h);
  const VecX end = y + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  mean = to_state(t_s + h, {end.data(), static_cast<size_t>(end.size())});
}

void MotionModel::add_noise(MatX& covariance, double length_s) const {
  const Mat3 about = free_axes();
  const double q = std::pow(settings_.rate_walk_rad_s_rts, 2), h = length_s;
  covariance.topLeftCorner<3, 3>() += q * h * h * h / 3.0 * about;
  covariance.block<3, 3>(attitude, rate) += 0.5 * q * h * h * about;
  covariance.block<3, 3>(rate, attitude) += 0.5 * q * h * h * about;
  covariance.block<3, 3>(rate, rate) += q * h * about;
  add_parameter_walks(covariance, h);
}

void MotionModel::add_parameter_walks(MatX& covariance, double length_s) const {
  for (size_t i = 0; i < places_.size(); ++i) {
    const Eigen::Index at = first_parameter() + static_cast<Eigen::Index>(i);
    covariance(at, at) += std::pow(places_[i].walk_rts, 2) * length_s;
  }
}

// Motion by gyro readings: the attitude rotates by the mean of the rates before and after, where
// the latter is the gyro reading.
void MotionModel::drive(FilterState& state, double length_s, const Vec3& gyro_rad_s,
                        Transition& whole) const {
  const double h = length_s;
  FilterState end = state;
  end.mean.time_s += h;
  // Readings depend on the attitude only by the Earth's rotation, so a first guess is sufficient.
  end.mean.lab_from_body =
      (state.mean.lab_from_body * turn_by(h * state.mean.rate_body_rad_s)).normalized();
  const Prediction reading = predicted_readings(end);
  const Mat3 by_rate = reading.derivative.block<3, 3>(0, rate);
  const Mat3 inverse = by_rate.inverse();
  end.mean.rate_body_rad_s += inverse * (gyro_rad_s - reading.gyro_rad_s);
  const Vec3 turn_rad = 0.5 * h * (state.mean.rate_body_rad_s + end.mean.rate_body_rad_s);
  end.mean.lab_from_body = (state.mean.lab_from_body * turn_by(turn_rad)).normalized();
  // Errors of the new rate result only from those of the parameters and from the gyro's noise.
  MatX by_before = MatX::Identity(size_, size_);
  const Mat3 back = turn_by(-turn_rad).toRotationMatrix();
  MatX new_rate = MatX::Zero(3, size_);
  const Eigen::Index own = size_ - first_parameter();
  new_rate.rightCols(own) = -inverse * reading.derivative.topRightCorner(3, own);
  by_before.topLeftCorner<3, 3>() = back;
  // Derivative of the attitude after the rotation with respect to either rate.
  const Mat3 by_rates = 0.5 * h * turn_jacobian(-turn_rad);
  by_before.block<3, 3>(attitude, rate) = by_rates;
  by_before.topRightCorner(3, own) = by_rates * new_rate.rightCols(own);
  by_before.middleRows<3>(rate) = new_rate;
  MatX enters = MatX::Zero(size_, 3);
  enters.topRows<3>() = by_rates * inverse;
  enters.middleRows<3>(rate) = inverse;
  const double gyro_noise_rad_s = sensors_.gyro ? sensors_.gyro->noise_rad_s : 0.0;
  MatX noise = std::pow(gyro_noise_rad_s, 2) * enters * enters.transpose();
  add_parameter_walks(noise, h);
  state = std::move(end);
  whole.covariance = by_before * whole.covariance * by_before.transpose() + noise;
  whole.phi = by_before * whole.phi;
}

Transition MotionModel::advance(FilterState& state, double time_s, const Vec3& gyro_rad_s) const {
  Transition whole{MatX::Identity(size_, size_), MatX::Zero(size_, size_)};
  const double length_s = time_s - state.mean.time_s;
  if (!(length_s > 0.0)) return whole;
  if (settings_.motion == Motion::gyro_drives && gyro_rad_s.allFinite()) {
    drive(state, length_s, gyro_rad_s, whole);
  } else {
    const double least = std::ceil(length_s / step_length_s(state, length_s) - 1e-9);
    if (!(least <= most_steps)) {
      throw NumericalError("the motion is too fast for the " + shortest(length_s) +
                           " s between two readings: leave out the readings before or after them");
    }
    const int steps = std::max(1, static_cast<int>(least));
    const double h = length_s / steps;
    for (int i = 0; i < steps; ++i) {
      // Derivatives at the middle of the step give second order, which is enough for the
      // covariance.
      FilterState middle = state;
      step(middle, 0.5 * h);
      const MatX a = h * rate_matrix(middle);
      MatX phi = MatX::Identity(size_, size_);
      for (int order = 4; order >= 1; --order) {
        phi = MatX::Identity(size_, size_) + a * phi / order;
      }
      step(state, h);
      whole.phi = phi * whole.phi;
      whole.covariance = phi * whole.covariance * phi.transpose();
      add_noise(whole.covariance, h);
    }
  }
  state.mean.time_s = time_s;
  state.covariance = whole.phi * state.covariance * whole.phi.transpose() + whole.covariance;
  state.covariance = 0.5 * (state.covariance + state.covariance.transpose()).eval();
  return whole;
}

void MotionModel::refuse_rows_far_apart(const Observation& seen, const AttitudeModel& model) {
  double fastest_1_s = seen.has_some_attitude() ? median_gyro_rate_rad_s(seen) : 0.0;
  try {
    const MotionModel motion(model, {}, {.uses_gyro = false}, seen.schedule);
    const FilterState first =
        motion.start(seen.time_s.front(), seen.attitude.front(), Mat3::Zero());
    fastest_1_s = std::max(fastest_1_s, oscillation_1_s(motion.rate_matrix(first)));
  } catch (const NumericalError&) {
    // The torques are not defined at this attitude: the fit reports it.
  }
  const double between = fastest_1_s * seen.row_interval_s;
  constexpr double longest = part_of_time_scale * most_steps / fewest_rows;
  if (!(between > longest)) return;
  throw InputError({seen.name, 0}, "t_s",
                   printed("rows %.4g s apart, between which the platform rotates or oscillates "
                           "through %.3g rad",
                           seen.row_interval_s, between),
                   printed("at most %.4g rad: is the unit of the time column another one (t_ms, "
                           "t_us)?",
                           longest));
}

void MotionModel::add(FilterState& state, const VecX& error) const {
  PlatformState& mean = state.mean;
  mean.lab_from_body = (mean.lab_from_body * turn_by(error.segment<3>(attitude))).normalized();
  mean.rate_body_rad_s += error.segment<3>(rate);
  for (int i = 0; i < extras_; ++i) mean.extra[static_cast<size_t>(i)] += error[extra + i];
  state.parameters += error.tail(state.parameters.size());
  refresh(state);
}

VecX MotionModel::difference(const FilterState& to, const FilterState& from) const {
  VecX error(size_);
  error.segment<3>(attitude) =
      turn_vector(from.mean.lab_from_body.conjugate() * to.mean.lab_from_body);
  error.segment<3>(rate) = to.mean.rate_body_rad_s - from.mean.rate_body_rad_s;
  for (int i = 0; i < extras_; ++i) {
    const auto at = static_cast<size_t>(i);
    error[extra + i] = to.mean.extra[at] - from.mean.extra[at];
  }
  error.tail(to.parameters.size()) = to.parameters - from.parameters;
  return error;
}

// Expected readings of the instruments, and their derivatives.

namespace {

// ∂q/∂θ for q ⊗ exp(θ): components w, x, y, z.
Eigen::Matrix<double, 4, 3> quaternion_by_turn(const Quat& q) {
  Eigen::Matrix<double, 4, 3> g;
  g << -q.x(), -q.y(), -q.z(), q.w(), -q.z(), q.y(), q.z(), q.w(), -q.x(), -q.y(), q.x(), q.w();
  return 0.5 * g;
}

}  // namespace

MatX MotionModel::derivatives_of(const FilterState& state, bool of_readings) const {
  const Dynamics& dynamics = *state.dynamics;
  const std::vector<double> mean = to_vector(state.mean);
  const std::vector<Lanes> y(mean.begin(), mean.end());
  std::array<ZeroOrderHold, Lanes::count> held;
  held.fill(model_.schedule.at(state.mean.time_s));
  const int components = dynamics.size();
  const int rows = of_readings ? Dynamics::reading_count : components;
  // Order: attitude and rate, extra states, parameters.
  const int variables = component::charge + extras_ + static_cast<int>(places_.size());
  MatX by_variable(rows, variables);
  std::vector<Lanes> out(static_cast<size_t>(rows) * DualLanes::block);
  Dynamics::Workspace room;
  for (int first = 0; first < variables; first += DualLanes::block) {
    Dynamics::Block block;
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
      dynamics.reading_derivatives(state.mean.time_s, held, y.data(), block, out.data(), room);
    } else {
      dynamics.derivatives(state.mean.time_s, held[0], y.data(), block, out.data(), room);
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
  return by_error;
}

MotionModel::Prediction MotionModel::predicted_readings(const FilterState& state) const {
  const Dynamics::Instants now = state.dynamics->at(state.mean);
  Prediction prediction{lane_of(now.gyro_rad_s, 0), lane_of(now.camera_error_rad, 0),
                        now.camera_delay_s[0], derivatives_of(state, true)};
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
  // In lab axes, in which the noise is stated and the measured axes are defined.
  const Vec3 residual_rad = mean * turn_vector((mean * error).conjugate() * lab_from_body);
  MatX derivative = MatX::Zero(3, size_);
  derivative.leftCols<3>() = error.conjugate().toRotationMatrix();
  derivative += reading.derivative.middleRows<3>(3);
  // With a longer delay, the reading shows an earlier attitude.
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

Measurement MotionModel::of_yaw(const FilterState& state, double seen_rad) const {
  const Vec3 ahead = state.mean.lab_from_body * Vec3::UnitX();
  const Mat3 by_turn = -state.mean.lab_from_body.toRotationMatrix() * skew(Vec3::UnitX());
  MatX derivative = MatX::Zero(1, size_);
  derivative.leftCols<3>() =
      (ahead.x() * by_turn.row(1) - ahead.y() * by_turn.row(0)) / ahead.head<2>().squaredNorm();
  const double difference_rad = std::remainder(seen_rad - yaw_rad(state.mean), 2.0 * pi);
  const double step_rad = sensors_.encoder ? sensors_.encoder->resolution_rad : 1e-4;
  // Uniform distribution within a step of the encoder.
  return {VecX::Constant(1, difference_rad), derivative,
          MatX::Constant(1, 1, step_rad * step_rad / 12.0)};
}

Vec3 MotionModel::inertial_rate_rad_s(const FilterState& state) const {
  return lane_of(state.dynamics->at(state.mean).inertial_rate_body_rad_s, 0);
}

double MotionModel::camera_delay_s() const {
  const FilterState state = start(0.0, Quat::Identity(), Mat3::Identity());
  return predicted_readings(state).camera_delay_s;
}

}  // namespace photorque
