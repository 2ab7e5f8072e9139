#include "attitude/propagation/propagator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/constants.h"

namespace photorque {
namespace {

// Laws for these tests only, so that they are independent of the disturbance kinds.

// T = m r × g from a start time on; parameters r (3), start time.
struct Offset final : LawOf<Offset> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    now.move_mass(active_from(now.time_s, values_of_start(own)) * own[VectorKey{"p"}]);
  }
  static double values_of_start(const ParametersAndStates<Lanes>& own) {
    return own[ScalarKey{"p", 3}][0];
  }
  static double values_of_start(const ParametersAndStates<DualLanes>& own) {
    return own[ScalarKey{"p", 3}].value[0];
  }
  std::vector<Switch> switches(std::span<const Parameter> p) const override {
    return {{p[3].value, 3}};
  }
};

// T = −c ω − k |ω|^½ ω; parameters c, k.
struct Drag final : TorqueLaw<Drag> {
  template <class T>
  Vec3Of<T> torque(const ParametersAndStates<T>& own, const EvaluationContext<T>& now) const {
    const Vec3Of<T>& w = now.rate_body_rad_s;
    return -(own[ScalarKey{"p", 0}] + own[ScalarKey{"p", 1}] * pow(length(w), 0.5)) * w;
  }
};

// A wheel on a spring about body x: inertia J, stiffness k; states: its absolute rate and its angle
// relative to the body.
struct SprungWheel final : LawOf<SprungWheel> {
  template <class T>
  void apply(const ParametersAndStates<T>& own, EvaluationContext<T>& now) const {
    const T &inertia = own[ScalarKey{"p", 0}], &stiffness = own[ScalarKey{"p", 1}];
    const Vec3Of<T> axis(T(1.0), T(0.0), T(0.0));
    now.detach_inertia(inertia * (axis * axis.transpose()));
    const T spring = stiffness * own.states[1];
    now.torque_body_N_m +=
        spring * axis - now.rate_body_rad_s.cross(Vec3Of<T>(inertia * own.states[0] * axis));
    own.state_rates[0] = -spring / inertia;
    own.state_rates[1] = own.states[0] - now.rate_body_rad_s[0];
  }
};

AttitudeModel free_body(const Mat3& inertia_kg_m2) {
  AttitudeModel model;
  model.platform.inertia_kg_m2 = inertia_kg_m2;
  return model;
}

template <class LawType>
Disturbance disturbance(std::vector<double> parameters, Stage stage = Stage::torque,
                        std::vector<ExtraState> states = {}) {
  return make_disturbance<LawType>({fixed_parameter("p", parameters)}, stage, std::move(states));
}

double angle_between_rad(const Quat& a, const Quat& b) {
  const Quat e = a.conjugate() * b;
  return 2.0 * std::atan2(e.vec().norm(), std::abs(e.w()));
}

// The torque-free body of shared reference attitude.md, section 6: computed in quadruple precision
// by a Taylor method of order 40, rates confirmed by Jacobi's elliptic functions.
struct Reference {
  double time_s;
  Quat lab_from_body;
  Vec3 rate_rad_s;
};
const std::vector<Reference>& references() {
  static const std::vector<Reference> all = {
      {10,
       {-6.9110011197605115410e-01, -6.3083832094917526903e-01, 4.0512740587742542993e-03,
        -3.5271409842274422863e-01},
       {4.8764727536177494227e-01, 3.1464158313677131206e-01, 7.4229419650242869638e-01}},
      {100,
       {-5.9747530888021991115e-01, 6.9260746501186454148e-01, 4.0325422454796424843e-01,
        2.6536485685649358918e-02},
       {4.7020400889365174258e-01, -1.2433442764699821939e-01, -7.9658078692728546428e-01}},
      {1000,
       {5.8710780373542570189e-01, -5.1805440558908385469e-01, -8.7066616984776827770e-03,
        -6.2197126435613897977e-01},
       {5.0343954134269659394e-01, 4.2101883442041350690e-01, 6.8756319059652723303e-01}},
      {10000,
       {-3.0715200717128203479e-01, -7.5230524584188804589e-01, 4.2090480813243466625e-01,
        -4.0315456596748034221e-01},
       {5.8537239322429414839e-01, -7.8949616449080249415e-01, 1.6338851322633342005e-01}},
      {100000,
       {5.9442666266515225370e-01, -7.7701057464352362963e-01, -2.0709558729710917510e-01,
        -4.7882488423132890032e-03},
       {5.1303822025821364645e-01, -4.7543777429709631335e-01, -6.5112128115384410629e-01}},
  };
  return all;
}

TEST(FreeBody, AgreesWithQuadruplePrecisionForADay) {
  const Mat3 inertia_kg_m2 = Vec3(500, 200, 300).asDiagonal();
  const Dynamics dynamics(free_body(inertia_kg_m2));
  PlatformState state = dynamics.initial_state();
  state.rate_body_rad_s = {0.5, -0.4, 0.7};
  std::vector<double> times_s;
  for (const Reference& reference : references()) times_s.push_back(reference.time_s);
  const std::clock_t before = std::clock();
  const Trajectory trajectory = propagate(dynamics, state, times_s);
  const double cpu_s = static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
  ASSERT_EQ(trajectory.states.size(), references().size());
  for (size_t i = 0; i < times_s.size(); ++i) {
    const PlatformState& at = trajectory.states[i];
    EXPECT_LT(angle_between_rad(at.lab_from_body, references()[i].lab_from_body), 1e-9);
    EXPECT_LT((at.rate_body_rad_s - references()[i].rate_rad_s).norm(), 1e-9);
  }
  RecordProperty("cpu_s", std::to_string(cpu_s));
  std::printf(
      "attitude error %.2e rad, %ld steps, %ld rejected, %.1f iterations, %.3f s\n",
      angle_between_rad(trajectory.states.back().lab_from_body, references().back().lab_from_body),
      trajectory.statistics.steps, trajectory.statistics.rejected,
      static_cast<double>(trajectory.statistics.iterations) / trajectory.statistics.steps, cpu_s);
}

// The rounding error of n steps is a random walk of a few units in the last place times √n. A drift
// of half a unit per step in one direction would be a hundred times larger.
TEST(FreeBody, KeepsEnergyAndMomentumToRounding) {
  const Mat3 inertia_kg_m2 = Vec3(500, 200, 300).asDiagonal();
  const Dynamics dynamics(free_body(inertia_kg_m2));
  PlatformState state = dynamics.initial_state();
  state.rate_body_rad_s = {0.5, -0.4, 0.7};
  Propagator propagator(dynamics, state, 1e5);
  const Vec3 momentum = inertia_kg_m2 * state.rate_body_rad_s;
  const double energy = state.rate_body_rad_s.dot(momentum);
  double worst_energy = 0.0, worst_momentum = 0.0;
  std::vector<Lanes> y(8);
  int steps = 0;
  while (propagator.advance()) {
    ++steps;
    propagator.dense(propagator.step_end_s(), y.data());
    const Quat q(y[0][0], y[1][0], y[2][0], y[3][0]);
    const Vec3 rate(y[4][0], y[5][0], y[6][0]);
    const Vec3 momentum_lab = q * (inertia_kg_m2 * rate);
    worst_energy = std::max(worst_energy, std::abs(rate.dot(inertia_kg_m2 * rate) / energy - 1.0));
    worst_momentum = std::max(worst_momentum, (momentum_lab - momentum).norm() / momentum.norm());
  }
  const double rounding = std::numeric_limits<double>::epsilon() * std::sqrt(steps);
  EXPECT_LT(worst_energy, 8 * rounding);
  EXPECT_LT(worst_momentum, 8 * rounding);
}

// A heavy platform that hangs below its bearing: period 2 π √(J/(m g d)) times 2 K(sin(θ/2))/π.
TEST(Pendulum, LargeSwingHasTheEllipticPeriod) {
  AttitudeModel model = free_body(Vec3(1.3, 1.3, 0.5).asDiagonal());
  model.platform.mass_kg = 29.0;
  model.disturbances = {disturbance<Offset>({0, 0, -81e-6, -1.0}, Stage::mass)};
  const Dynamics dynamics(model);
  PlatformState state = dynamics.initial_state();
  const double swing_rad = 1.2;
  state.lab_from_body = Quat(Eigen::AngleAxisd(swing_rad, Vec3::UnitX()));
  const double small_period_s = 2 * pi * std::sqrt(1.3 / (29.0 * standard_gravity_m_s2 * 81e-6));
  const double period_s = small_period_s * 2 / pi * std::comp_ellint_1(std::sin(swing_rad / 2));
  const Trajectory trajectory =
      propagate(dynamics, state, std::vector<double>{period_s / 4, period_s, 20 * period_s});
  EXPECT_NEAR(trajectory.states[0].lab_from_body.x(), 0.0, 1e-9);
  for (const size_t i : {1u, 2u}) {
    EXPECT_LT(angle_between_rad(trajectory.states[i].lab_from_body, state.lab_from_body), 1e-8);
    EXPECT_LT(trajectory.states[i].rate_body_rad_s.norm(), 1e-8);
  }
}

AttitudeModel everything() {
  Mat3 inertia_kg_m2;
  inertia_kg_m2 << 0.11, 0.002, -0.001, 0.002, 0.12, 0.003, -0.001, 0.003, 0.19;
  AttitudeModel model = free_body(inertia_kg_m2);
  model.platform.mass_kg = 7.0;
  model.disturbances = {
      disturbance<Offset>({2e-5, -1e-5, -3e-4, 12.345}, Stage::mass),
      disturbance<Drag>({1e-4, 2e-3}),
      disturbance<SprungWheel>({0.004, 0.1}, Stage::torque,
                               {{"wheel_rate_rad_s", 0.1, 1.0}, {"wheel_angle_rad", 0.05, 1.0}}),
      disturbance<Drag>({-3e-5, 1e-4}),
  };
  model.schedule.append(0.0, {.command_body_N_m = {1e-4, 0, 0}, .battery_current_A = 1.5});
  model.schedule.append(3.21, {.command_body_N_m = {0, -2e-4, 1e-4}, .battery_current_A = 0.5});
  model.schedule.append(20.0, {});
  return model;
}

PlatformState tumbling(const Dynamics& dynamics) {
  PlatformState state = dynamics.initial_state();
  state.lab_from_body = Quat(Eigen::AngleAxisd(0.3, Vec3(1, 2, -1).normalized()));
  state.rate_body_rad_s = {0.05, -0.04, 0.1};
  return state;
}

TEST(Derivatives, MatchDifferencesForEveryParameterAndInitialValue) {
  const AttitudeModel model = everything();
  const Dynamics dynamics(model);
  const PlatformState initial = tumbling(dynamics);
  std::vector<Variable> variables;
  for (int i = 0; i < 9; ++i) variables.push_back({i, 0, -1});
  for (size_t d = 0; d < model.disturbances.size(); ++d) {
    for (size_t p = 0; p < model.disturbances[d].parameters.size(); ++p) {
      variables.push_back(Variable::of(d, static_cast<int>(p)));
    }
  }
  const std::vector<double> times_s = {0.0, 7.7, 12.345, 29.0, 60.0};
  PropagationOptions fine;
  fine.tolerance = 1e-12;
  const Trajectory exact = propagate(dynamics, initial, times_s, fine, variables);

  const auto shifted = [&](const Variable& v, double by) {
    AttitudeModel changed = model;
    PlatformState state = initial;
    if (v.initial < 0) {
      changed.disturbances[v.disturbance].parameters[static_cast<size_t>(v.parameter)].value += by;
    } else if (v.initial < 3) {
      state.lab_from_body =
          state.lab_from_body * Quat(Eigen::AngleAxisd(by, Vec3::Unit(v.initial)));
    } else if (v.initial < 6) {
      state.rate_body_rad_s[v.initial - 3] += by;
    } else if (v.initial == 6) {
      state.charge_drawn_C += by;
    } else {
      state.extra[static_cast<size_t>(v.initial - 7)] += by;
    }
    return propagate(Dynamics(changed), state, times_s, fine).states;
  };
  for (size_t v = 0; v < variables.size(); ++v) {
    const double value = variables[v].initial >= 0
                             ? 0.1
                             : model.disturbances[variables[v].disturbance]
                                   .parameters[static_cast<size_t>(variables[v].parameter)]
                                   .value;
    const double by = 1e-5 * std::max(std::abs(value), 1e-5);
    const auto up = shifted(variables[v], by), down = shifted(variables[v], -by);
    for (size_t i = 0; i < times_s.size(); ++i) {
      // At the jump itself a difference is not a derivative.
      if (times_s[i] == 12.345) continue;
      const Quat turn = exact.states[i].lab_from_body.conjugate() * up[i].lab_from_body;
      const Quat back = exact.states[i].lab_from_body.conjugate() * down[i].lab_from_body;
      const Vec3 rotation = 2.0 * (turn.vec() / turn.w() - back.vec() / back.w()) / (2 * by);
      const Vec3 rate = (up[i].rate_body_rad_s - down[i].rate_body_rad_s) / (2 * by);
      std::vector<double> difference = {rotation[0],
                                        rotation[1],
                                        rotation[2],
                                        rate[0],
                                        rate[1],
                                        rate[2],
                                        (up[i].charge_drawn_C - down[i].charge_drawn_C) / (2 * by)};
      for (size_t e = 0; e < 2; ++e) {
        difference.push_back((up[i].extra[e] - down[i].extra[e]) / (2 * by));
      }
      double size = 0.0;
      for (const double x : difference) size = std::max(size, std::abs(x));
      for (size_t c = 0; c < exact.components; ++c) {
        const double derivative =
            exact.derivatives[(i * exact.components + c) * variables.size() + v];
        EXPECT_NEAR(derivative, difference[c], 2e-6 * size + 1e-7)
            << "variable " << v << " component " << c << " time " << times_s[i];
      }
    }
  }
}

}  // namespace
}  // namespace photorque
