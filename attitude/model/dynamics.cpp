#include "attitude/model/dynamics.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "attitude/model/disturbance.h"
#include "core/errors.h"

namespace photorque {

namespace {

double sign_of(Slip slip) {
  return slip == Slip::forward ? 1.0 : slip == Slip::backward ? -1.0 : 0.0;
}

// 1 where friction holds the platform, 0 elsewhere.
template <class T>
T sticks(const EvaluationContext<T>& now) {
  return now.slip_is_held * (1.0 - now.slip_sign * now.slip_sign);
}

// q' = ½ q ⊗ (0, ω).
template <class T>
void turn(const QuatOf<T>& q, const Vec3Of<T>& w, T* rates) {
  rates[0] = -0.5 * (q.x() * w.x() + q.y() * w.y() + q.z() * w.z());
  rates[1] = 0.5 * (q.w() * w.x() + q.y() * w.z() - q.z() * w.y());
  rates[2] = 0.5 * (q.w() * w.y() + q.z() * w.x() - q.x() * w.z());
  rates[3] = 0.5 * (q.w() * w.z() + q.x() * w.y() - q.y() * w.x());
}

}  // namespace

std::vector<double> to_vector(const PlatformState& state) {
  const Quat& q = state.lab_from_body;
  const Vec3& w = state.rate_body_rad_s;
  std::vector<double> y = {q.w(), q.x(), q.y(), q.z(), w.x(), w.y(), w.z(), state.charge_drawn_C};
  y.insert(y.end(), state.extra.begin(), state.extra.end());
  return y;
}

PlatformState to_state(double time_s, std::span<const double> y) {
  PlatformState state;
  state.time_s = time_s;
  state.lab_from_body = Quat(y[0], y[1], y[2], y[3]).normalized();
  state.rate_body_rad_s = {y[4], y[5], y[6]};
  state.charge_drawn_C = y[component::charge];
  state.extra.assign(y.begin() + component::extra, y.end());
  return state;
}

std::vector<double> lane_of(std::span<const Lanes> y, int lane) {
  std::vector<double> components;
  for (const Lanes& x : y) components.push_back(x[lane]);
  return components;
}

double command_delay_s(std::span<const Disturbance> disturbances) {
  double sum_s = 0.0;
  for (const Disturbance& disturbance : disturbances) sum_s += disturbance.command_delay_s;
  return sum_s;
}

Dynamics::Dynamics(AttitudeModel model) : model_(std::move(model)) {
  const auto& all = model_.disturbances;
  model_.schedule.command_delay_s = command_delay_s(all);
  scales_.assign(component::extra, 1.0);
  for (const Disturbance& d : all) {
    layout_.push_back({size_, static_cast<int>(parameters_.size())});
    for (const ExtraState& state : d.states) scales_.push_back(state.scale);
    for (const Parameter& parameter : d.parameters) parameters_.emplace_back(parameter.value);
    if (d.kind == translation_kind) translation_ = size_;
    size_ += static_cast<int>(d.states.size());
  }
  for (const Stage stage : {Stage::conditions, Stage::mass, Stage::torque}) {
    for (size_t d = 0; d < all.size(); ++d) {
      if (all[d].stage == stage) order_.push_back(d);
    }
  }
  for (size_t d = 0; d < all.size(); ++d) {
    if (all[d].stage == Stage::measurement) instruments_.push_back(d);
  }
  if (model_.platform.slides() && translation_ < 0) {
    throw NumericalError("the platform has no position to estimate");
  }
  const Eigen::FullPivLU<Mat3> lu(model_.platform.inertia_kg_m2);
  if (!lu.isInvertible()) throw NumericalError("the platform's inertia is singular");
  inverse_inertia_1_kg_m2_ = lu.inverse();
  try_laws();
}

// Determines which laws change the inertia, and whether the offsets of the instruments depend on
// the motion. Both are tested with two states and other parameters.
void Dynamics::try_laws() {
  changes_inertia_.assign(model_.disturbances.size(), false);
  const PlatformState rest = initial_state();
  PlatformState moving = initial_state(Vec3(0.03, -0.02, 0.05));
  moving.lab_from_body = Quat(Eigen::AngleAxisd(0.3, Vec3(0.6, 0.0, 0.8)));
  moving.charge_drawn_C = 100.0;
  std::vector<Lanes> others = parameters_;
  for (size_t p = 0; p < others.size(); ++p) others[p] += 1e-3 * static_cast<double>(p + 1);
  const Offsets as_stated = tried(rest, parameters_);
  try {
    if (tried(rest, others) == tried(moving, others)) offsets_ = as_stated;
  } catch (const NumericalError&) {
    // The states lie outside a table: the offsets are computed at every state.
  }
}

// Offsets of the instruments at `state`, with these parameters of the instruments. Also sets
// changes_inertia_.
Dynamics::Offsets Dynamics::tried(const PlatformState& state,
                                  const std::vector<Lanes>& instruments) {
  const std::vector<double> start = to_vector(state);
  const std::vector<Lanes> y(start.begin(), start.end());
  std::vector<Lanes> rates(y.size(), Lanes(0.0));
  EvaluationContext<Lanes> now = begin(Lanes(0.0), broadcast({}, 0.0), y.data());
  const auto act = [&](size_t d) {
    const bool is_instrument = model_.disturbances[d].stage == Stage::measurement;
    now.inertia_changed = false;
    apply_law(d, is_instrument ? instruments : parameters_, y.data(), rates.data(), now);
    changes_inertia_[d] = changes_inertia_[d] || now.inertia_changed;
  };
  run_stages(order_, now, act);
  for (const size_t d : instruments_) act(d);
  Offsets offsets;
  for (int k = 0; k < 3; ++k) {
    offsets.gyro_rad_s[k] = now.inertial_rate_body_rad_s[k][0] - now.rate_body_rad_s[k][0];
    offsets.gyro_rad_s[k] += now.gyro_error_rad_s[k][0];
    offsets.camera_rad[k] = now.camera_error_rad[k][0];
  }
  offsets.camera_delay_s = now.camera_delay_s[0];
  return offsets;
}

PlatformState Dynamics::initial_state(const Vec3& rate_body_rad_s, double turned_rad) const {
  PlatformState state;
  state.rate_body_rad_s = rate_body_rad_s;
  for (const Disturbance& d : model_.disturbances) {
    for (const ExtraState& extra : d.states) {
      state.extra.push_back(initial_value(d, extra, rate_body_rad_s, turned_rad));
    }
  }
  return state;
}

Dynamics::Command Dynamics::broadcast(const ZeroOrderHold& held, const Lanes& time_s) {
  const ContinuedTorque& light = held.light_body;
  const Lanes t = time_s - light.from_s;
  Command command{.torque_body_N_m = held.command_body_N_m.cast<Lanes>(),
                  .force_lab_N = held.force_lab_N.cast<Lanes>(),
                  .force_body_N = held.force_body_N.cast<Lanes>(),
                  .battery_current_A = held.battery_current_A,
                  .led_current_A = held.led_current_A,
                  .lamps_as_stated = held.lamps_as_stated,
                  .light_body_N_m = {},
                  .wheel_rad_s = {},
                  .wheel_rad_s2 = {},
                  .slip_is_held = held.slip == Slip::by_rate ? 0.0 : 1.0,
                  .slip_sign = sign_of(held.slip)};
  for (int k = 0; k < 3; ++k) {
    command.light_body_N_m[k] =
        light.value_N_m[k] + t * (light.rate_N_m_s[k] + t * light.curvature_N_m_s2[k]);
    command.wheel_rad_s[k] = held.wheel.speed_rad_s[k] +
                             (time_s - held.wheel.from_s) * held.wheel.acceleration_rad_s2[k];
    command.wheel_rad_s2[k] = held.wheel.acceleration_rad_s2[k];
  }
  return command;
}

Dynamics::Command Dynamics::gather(const std::array<ZeroOrderHold, Lanes::count>& held,
                                   const Lanes& time_s) {
  Command command;
  for (int i = 0; i < Lanes::count; ++i) {
    const ZeroOrderHold& lane = held[static_cast<size_t>(i)];
    const Vec3 light_N_m = lane.light_body.at(time_s[i]), wheel_rad_s = lane.wheel.at(time_s[i]);
    for (int k = 0; k < 3; ++k) {
      command.torque_body_N_m[k].set(i, lane.command_body_N_m[k]);
      command.force_lab_N[k].set(i, lane.force_lab_N[k]);
      command.force_body_N[k].set(i, lane.force_body_N[k]);
      command.light_body_N_m[k].set(i, light_N_m[k]);
      command.wheel_rad_s[k].set(i, wheel_rad_s[k]);
      command.wheel_rad_s2[k].set(i, lane.wheel.acceleration_rad_s2[k]);
    }
    command.slip_is_held.set(i, lane.slip == Slip::by_rate ? 0.0 : 1.0);
    command.slip_sign.set(i, sign_of(lane.slip));
    command.battery_current_A.set(i, lane.battery_current_A);
    command.led_current_A.set(i, lane.led_current_A);
    command.lamps_as_stated.set(i, lane.lamps_as_stated);
  }
  return command;
}

template <class T>
EvaluationContext<T> Dynamics::begin(const T& time_s, const Command& command, const T* y) const {
  const Platform& platform = model_.platform;
  const Environment& environment = model_.environment;
  const Vec3Of<T> zero = Vec3Of<T>::Constant(T(0.0));
  const QuatOf<T> attitude(y[0], y[1], y[2], y[3]);
  const Vec3Of<T> rate(y[4], y[5], y[6]);
  const Mat3Of<T> lab_from_body = attitude.toRotationMatrix();
  Vec3Of<T> position = zero, velocity = zero, commanded = zero;
  for (int i = 0; translation_ >= 0 && i < 2; ++i) {
    position[i] = y[translation_ + i];
    velocity[i] = y[translation_ + 2 + i];
    commanded[i] = command.force_lab_N[i];
    for (int k = 0; k < 2; ++k) commanded[i] += lab_from_body(i, k) * command.force_body_N[k];
  }
  return {.platform = platform,
          .environment = environment,
          .time_s = time_s,
          .attitude = attitude,
          .lab_from_body = lab_from_body,
          .rate_body_rad_s = rate,
          .charge_drawn_C = y[component::charge],
          .mass_kg = platform.mass_kg,
          .inertia_kg_m2 = platform.inertia_kg_m2.cast<T>(),
          .gravity_lab_m_s2 = environment.gravity_lab_m_s2.cast<T>(),
          .magnetic_field_lab_T = environment.magnetic_field_lab_T.cast<T>(),
          .up_lab = environment.up_lab.cast<T>(),
          .gravity_gradient_1_s2 = environment.gravity_gradient_1_s2,
          .illumination = 1.0,
          .orbit_position_lab_m = zero,
          .orbit_velocity_lab_m_s = zero,
          .command_body_N_m = command.torque_body_N_m.template cast<T>(),
          .command_lab_N = commanded,
          .battery_current_A = command.battery_current_A,
          .current_is_measured = model_.schedule.current_is_measured,
          .led_current_A = command.led_current_A,
          .lamps_as_stated = command.lamps_as_stated,
          .array_power_W = 0.0,
          .traced_light_body_N_m = command.light_body_N_m.template cast<T>(),
          .wheel_rad_s = command.wheel_rad_s.template cast<T>(),
          .wheel_rad_s2 = command.wheel_rad_s2.template cast<T>(),
          .slip_is_held = command.slip_is_held,
          .slip_sign = command.slip_sign,
          .position_lab_m = position,
          .velocity_lab_m_s = velocity,
          .gravity_body_m_s2 = zero,
          .magnetic_field_body_T = zero,
          .up_body = zero,
          .mass_offset_body_m = zero,
          .torque_body_N_m = zero,
          .force_lab_N = zero,
          .detached_inertia_kg_m2 = Mat3Of<T>::Constant(T(0.0)),
          .inertial_rate_body_rad_s = rate,
          .gyro_error_rad_s = zero,
          .camera_error_rad = zero,
          .camera_delay_s = 0.0};
}

// Calls act(d) for every disturbance of `order`, and brings the conditions into body axes as soon
// as they are final.
template <class T, class Act>
void Dynamics::run_stages(const std::vector<size_t>& order, EvaluationContext<T>& now,
                          const Act& act) const {
  auto d = order.begin();
  for (; d != order.end() && model_.disturbances[*d].stage == Stage::conditions; ++d) act(*d);
  now.gravity_body_m_s2 = now.to_body(now.gravity_lab_m_s2);
  now.magnetic_field_body_T = now.to_body(now.magnetic_field_lab_T);
  now.up_body = now.to_body(now.up_lab);
  now.torque_body_N_m += now.command_body_N_m;
  now.force_lab_N += now.command_lab_N;
  for (; d != order.end(); ++d) act(*d);
}

template <class T>
void Dynamics::put_attitude_rates(const T* y, T* rates) const {
  if (model_.holds_attitude) {
    for (int i = 0; i < 4; ++i) rates[i] = T(0.0);
    return;
  }
  turn(QuatOf<T>(y[0], y[1], y[2], y[3]), Vec3Of<T>(y[4], y[5], y[6]), rates);
}

// The acceleration where the bearings allow rotation about one axis.
template <class T>
Vec3Of<T> Dynamics::about_axis(const Vec3Of<T>& torque_N_m, const Mat3Of<T>& inertia_kg_m2) const {
  const Vec3Of<T> axis = model_.platform.axis.cast<T>();
  const Vec3Of<T> column = inertia_kg_m2 * axis;
  const T size = axis.dot(torque_N_m) / axis.dot(column);
  return size * axis;
}

template <class T>
void Dynamics::solve(const EvaluationContext<T>& now, const T* y, T* rates) const {
  const Vec3Of<T>& w = now.rate_body_rad_s;
  put_attitude_rates(y, rates);
  Vec3Of<T> acceleration;
  if (model_.platform.turns_about_one_axis()) {
    const Mat3Of<T> inertia = now.inertia_kg_m2 - now.detached_inertia_kg_m2;
    acceleration = (1.0 - sticks(now)) * about_axis<T>(now.torque_body_N_m, inertia);
  } else if (now.inertia_changed) {
    const Mat3Of<T> inertia = now.inertia_kg_m2 - now.detached_inertia_kg_m2;
    // The inverse from cross products of the columns: Eigen's inverse needs comparisons of scalars.
    const Vec3Of<T> a = inertia.col(0), b = inertia.col(1), c = inertia.col(2);
    const Vec3Of<T> bc = b.cross(c), ca = c.cross(a), ab = a.cross(b);
    const Vec3Of<T> torque = now.torque_body_N_m - w.cross(Vec3Of<T>(inertia * w));
    acceleration = Vec3Of<T>(bc.dot(torque), ca.dot(torque), ab.dot(torque)) / a.dot(bc);
  } else {
    const Vec3Of<T> momentum = now.inertia_kg_m2 * w;
    acceleration = inverse_inertia_1_kg_m2_.cast<T>() * (now.torque_body_N_m - w.cross(momentum));
  }
  for (int i = 0; i < 3; ++i) rates[component::rate + i] = acceleration[i];
  rates[component::charge] = now.battery_current_A;
  for (int i = 0; translation_ >= 0 && i < 2; ++i) {
    rates[translation_ + i] = now.velocity_lab_m_s[i];
    rates[translation_ + 2 + i] = now.force_lab_N[i] / now.mass_kg;
  }
}

// The rates of solve() without disturbances: only the command acts. Needs no evaluation context.
void Dynamics::free_body_rates(const Command& command, const Lanes* y, Lanes* rates) const {
  const Vec3Of<Lanes> w(y[4], y[5], y[6]);
  put_attitude_rates(y, rates);
  const Mat3Of<Lanes> inertia = model_.platform.inertia_kg_m2.cast<Lanes>();
  const Vec3Of<Lanes> momentum = inertia * w;
  Vec3Of<Lanes> acceleration;
  if (model_.platform.turns_about_one_axis()) {
    acceleration = about_axis<Lanes>(command.torque_body_N_m, inertia);
  } else {
    acceleration =
        inverse_inertia_1_kg_m2_.cast<Lanes>() * (command.torque_body_N_m - w.cross(momentum));
  }
  for (int i = 0; i < 3; ++i) rates[component::rate + i] = acceleration[i];
  rates[component::charge] = command.battery_current_A;
}

void Dynamics::rates(const Lanes& time_s, const ZeroOrderHold& held, const Lanes* y,
                     Lanes* rates) const {
  if (order_.empty()) return free_body_rates(broadcast(held, time_s), y, rates);
  EvaluationContext<Lanes> now = begin(time_s, broadcast(held, time_s), y);
  run_stages(order_, now, [&](size_t d) { apply_law(d, parameters_, y, rates, now); });
  solve(now, y, rates);
}

// Applies the law of disturbance d to values without derivatives.
void Dynamics::apply_law(size_t d, const std::vector<Lanes>& parameters, const Lanes* y,
                         Lanes* rates, EvaluationContext<Lanes>& now) const {
  const Layout& own = layout_[d];
  model_.disturbances[d].law->act(
      {parameters.data() + own.first_parameter, y + own.first_state, rates + own.first_state}, now);
}

Dynamics::Instants Dynamics::at(const Lanes& time_s,
                                const std::array<ZeroOrderHold, Lanes::count>& held,
                                const Lanes* y) const {
  Instants result;
  result.force_lab_N.assign(model_.disturbances.size(), Vec3Of<Lanes>::Constant(Lanes(0.0)));
  result.torque_body_N_m.assign(model_.disturbances.size(), Vec3Of<Lanes>::Constant(Lanes(0.0)));
  result.rates.assign(static_cast<size_t>(size_), Lanes(0.0));
  EvaluationContext<Lanes> now = begin(time_s, gather(held, time_s), y);
  const auto act = [&](size_t d) {
    const Vec3Of<Lanes> before = now.torque_body_N_m, force_before = now.force_lab_N;
    const Mat3Of<Lanes> attached = now.detached_inertia_kg_m2;
    apply_law(d, parameters_, y, result.rates.data(), now);
    result.force_lab_N[d] = now.force_lab_N - force_before;
    // A detached part that moves with the body exerts only the gyroscopic torque of a rigid body,
    // which solve() does not include for detached parts.
    const Vec3Of<Lanes>& w = now.rate_body_rad_s;
    const Vec3Of<Lanes> carried = Mat3Of<Lanes>(now.detached_inertia_kg_m2 - attached) * w;
    result.torque_body_N_m[d] = now.torque_body_N_m - before + w.cross(carried);
  };
  run_stages(order_, now, act);
  // A platform that sticks: dry friction balances the sum of the other torques.
  for (size_t d = 0; d < model_.disturbances.size(); ++d) {
    if (!model_.disturbances[d].is_dry_friction) continue;
    const Vec3Of<Lanes> axis = model_.platform.axis.cast<Lanes>();
    const Lanes rest = sticks(now) * axis.dot(now.torque_body_N_m);
    result.torque_body_N_m[d] -= rest * axis;
    break;
  }
  solve(now, y, result.rates.data());
  for (const size_t d : instruments_) act(d);
  result.command_body_N_m = now.command_body_N_m;
  result.command_lab_N = now.command_lab_N;
  result.mass_offset_body_m = now.mass_offset_body_m;
  result.battery_current_A = now.battery_current_A;
  result.array_power_W = now.array_power_W;
  result.illumination = now.illumination;
  result.gravity_gradient_1_s2 = now.gravity_gradient_1_s2;
  result.inertial_rate_body_rad_s = now.inertial_rate_body_rad_s;
  result.gyro_rad_s = now.inertial_rate_body_rad_s + now.gyro_error_rad_s;
  result.camera_error_rad = now.camera_error_rad;
  result.camera_delay_s = now.camera_delay_s;
  return result;
}

EvaluationContext<DualLanes> Dynamics::differentiate(const Lanes& time_s, const Command& command,
                                                     const Lanes* y, const Block& block,
                                                     bool with_instruments, Workspace& room) const {
  std::vector<DualLanes>&y_dual = room.y, &own_parameters = room.parameters, &rates = room.rates;
  y_dual.assign(y, y + size_);
  bool everything = false;
  for (int k = 0; k < DualLanes::block; ++k) {
    if (block.state[k] < 0) continue;
    y_dual[static_cast<size_t>(block.state[k])].seed(k);
    everything =
        everything || block.state[k] < component::extra ||
        (translation_ >= 0 && block.state[k] >= translation_ && block.state[k] < translation_ + 4);
  }
  // A torque depends on the body's state, on the parameters and states of its disturbance, and on
  // the results of earlier stages. Therefore disturbances of earlier stages always act. So do those
  // that change the inertia, by which all torques are divided.
  const auto owns = [&](size_t d) {
    const Disturbance& disturbance = model_.disturbances[d];
    const Layout& own = layout_[d];
    const auto inside = [](int index, int first, size_t count) {
      return index >= first && index < first + static_cast<int>(count);
    };
    for (int k = 0; k < DualLanes::block; ++k) {
      if (inside(block.parameter[k], own.first_parameter, disturbance.parameters.size()) ||
          inside(block.state[k], own.first_state, disturbance.states.size())) {
        return true;
      }
    }
    return false;
  };
  // Torques affect the instruments only through the state.
  std::vector<size_t>&acting = room.acting, &owners = room.owners;
  acting.clear();
  owners.clear();
  for (const size_t d : order_) {
    if (with_instruments && model_.disturbances[d].stage == Stage::torque) continue;
    acting.push_back(d);
    const bool reaches_all = model_.disturbances[d].stage < Stage::torque || changes_inertia_[d],
               owner = owns(d);
    if (reaches_all || owner) owners.push_back(d);
    everything = everything || (reaches_all && owner);
  }
  // An instrument's error may be proportional to its input.
  everything = everything ||
               (with_instruments && std::any_of(instruments_.begin(), instruments_.end(), owns));

  rates.assign(static_cast<size_t>(size_), DualLanes(0.0));
  EvaluationContext<DualLanes> now = begin(DualLanes(time_s), command, y_dual.data());
  const auto act = [&](size_t d) {
    const Disturbance& disturbance = model_.disturbances[d];
    const Layout& own = layout_[d];
    const Lanes* first = parameters_.data() + own.first_parameter;
    own_parameters.assign(first, first + disturbance.parameters.size());
    for (int k = 0; k < DualLanes::block; ++k) {
      const int index = block.parameter[k] - own.first_parameter;
      if (index >= 0 && index < static_cast<int>(own_parameters.size())) {
        own_parameters[static_cast<size_t>(index)].seed(k);
      }
    }
    disturbance.law->act(
        {own_parameters.data(), y_dual.data() + own.first_state, rates.data() + own.first_state},
        now);
  };
  run_stages(everything ? acting : owners, now, act);
  if (with_instruments) {
    for (const size_t d : instruments_) act(d);
  } else {
    solve(now, y_dual.data(), rates.data());
  }
  return now;
}

void Dynamics::derivatives(const Lanes& time_s, const ZeroOrderHold& held, const Lanes* y,
                           const Block& block, Lanes* derivatives, Workspace& room) const {
  differentiate(time_s, broadcast(held, time_s), y, block, false, room);
  for (const DualLanes& rate : room.rates) {
    const DualLanes::Partials partials = rate.partials();
    derivatives = std::copy(partials.begin(), partials.end(), derivatives);
  }
}

void Dynamics::reading_derivatives(const Lanes& time_s,
                                   const std::array<ZeroOrderHold, Lanes::count>& held,
                                   const Lanes* y, const Block& block, Lanes* derivatives,
                                   Workspace& room) const {
  const EvaluationContext<DualLanes> now =
      differentiate(time_s, gather(held, time_s), y, block, true, room);
  const auto put = [&](const DualLanes& x) {
    const DualLanes::Partials partials = x.partials();
    derivatives = std::copy(partials.begin(), partials.end(), derivatives);
  };
  for (int i = 0; i < 3; ++i) put(now.inertial_rate_body_rad_s[i] + now.gyro_error_rad_s[i]);
  for (int i = 0; i < 3; ++i) put(now.camera_error_rad[i]);
  put(now.camera_delay_s);
}

Dynamics::Instants Dynamics::at(const PlatformState& state) const {
  const std::vector<double> numbers = to_vector(state);
  const std::vector<Lanes> y(numbers.begin(), numbers.end());
  std::array<ZeroOrderHold, Lanes::count> held;
  held.fill(model_.schedule.at(state.time_s));
  return at(state.time_s, held, y.data());
}

// The torque and force of every disturbance at one state, and the disturbance with the position and
// velocity of a planar platform.

namespace {

std::vector<Vec3> vectors_of_first_lane(const std::vector<Vec3Of<Lanes>>& all) {
  std::vector<Vec3> vectors;
  for (const Vec3Of<Lanes>& v : all) vectors.push_back(lane_of(v, 0));
  return vectors;
}

}  // namespace

std::vector<Vec3> disturbance_torques_body_N_m(const AttitudeModel& model,
                                               const PlatformState& state) {
  return vectors_of_first_lane(Dynamics(model).at(state).torque_body_N_m);
}

std::vector<Vec3> disturbance_forces_lab_N(const AttitudeModel& model, const PlatformState& state) {
  return vectors_of_first_lane(Dynamics(model).at(state).force_lab_N);
}

Disturbance translation() {
  // A deviation of 0.1 m is as important as one of 1 rad.
  constexpr double scale = 0.1;
  const auto state = [](const char* name) { return ExtraState{name, 0.0, scale}; };
  Disturbance d = make_disturbance<NoLaw>({}, Stage::torque,
                                          {state("position_x_m"), state("position_y_m"),
                                           state("velocity_x_m_s"), state("velocity_y_m_s")});
  d.kind = translation_kind;
  return d;
}

bool depends_on_attitude(const AttitudeModel& model) {
  const Dynamics dynamics(model);
  const bool about_axis = model.platform.turns_about_one_axis();
  // Attitudes that are unrelated by symmetry, with different rates.
  std::vector<Lanes> y(static_cast<size_t>(dynamics.size()), Lanes(0.0));
  std::vector<Lanes> turned = y;
  for (int lane = 0; lane < Lanes::count; ++lane) {
    const double n = lane + 1.0;
    const Vec3 axis = about_axis ? model.platform.axis
                                 : Vec3(std::sin(n), std::cos(1.7 * n), std::sin(2.3 * n + 0.4));
    const std::vector<double> state = to_vector(dynamics.initial_state(0.3 * n * axis));
    for (size_t c = component::rate; c < y.size(); ++c) y[c].set(lane, state[c]);
    const Vec3 other = about_axis ? axis : Vec3(std::cos(n), 0.3, std::sin(3.1 * n));
    const Quat q(Eigen::AngleAxisd(0.7 * n, axis.normalized()));
    const Quat r = q * Quat(Eigen::AngleAxisd(1.1, other.normalized()));
    const double from[] = {q.w(), q.x(), q.y(), q.z()}, to[] = {r.w(), r.x(), r.y(), r.z()};
    for (size_t c = 0; c < 4; ++c) y[c].set(lane, from[c]);
    for (size_t c = 0; c < y.size(); ++c) turned[c].set(lane, c < 4 ? to[c] : y[c][lane]);
  }
  std::vector<Lanes> here(y.size(), Lanes(0.0)), there = here;
  const ZeroOrderHold held =
      model.schedule.held.empty() ? ZeroOrderHold{} : model.schedule.held.back();
  dynamics.rates(Lanes(0.0), held, y.data(), here.data());
  dynamics.rates(Lanes(0.0), held, turned.data(), there.data());
  for (size_t c = component::rate; c < y.size(); ++c) {
    for (int lane = 0; lane < Lanes::count; ++lane) {
      const double a = here[c][lane], b = there[c][lane];
      if (std::abs(a - b) > 1e-9 * (std::abs(a) + std::abs(b))) return true;
    }
  }
  return false;
}

}  // namespace photorque
