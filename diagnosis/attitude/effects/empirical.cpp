#include "diagnosis/attitude/effects/trial.h"

namespace photorque {
namespace {

using enum TorqueAxes;
using enum FunctionForm;

EmpiricalLaw law(const std::string& description, EmpiricalShape shape, double scale) {
  EmpiricalLaw result;
  result.variable = name_of(shape.functions.front().of);
  result.description = description;
  result.disturbance = empirical_torque(shape);
  result.shape = std::move(shape);
  result.scale = scale;
  return result;
}

EmpiricalLaw with_free(EmpiricalLaw law, std::vector<double> starts, double lowest, double highest,
                       double scale) {
  law.starts = std::move(starts);
  law.lowest = lowest;
  law.highest = highest;
  law.own_scale = scale;
  return law;
}

MotionFunction harmonic(int order) {
  return {.of = MotionVariable::yaw, .form = harmonics, .orders = {order}};
}

// A formula is valid up to twice the recorded range, a table only within it.
constexpr double formula_reach = 2.0;

// A power of tilt or rate, normalised to 1 at 0.1 rad or 0.1 rad/s; `seen` is the maximum in the
// recordings.
MotionFunction power_of(MotionVariable variable, double exponent, double seen) {
  MotionFunction f{.of = variable, .form = power, .reference = 0.1, .own = exponent};
  if (seen > 0.0) f.range = {{0.0, formula_reach * seen}};
  return f;
}
MotionFunction powers_of(MotionVariable variable, std::vector<int> orders, double seen) {
  MotionFunction f = power_of(variable, 0.0, seen);
  f.form = powers;
  f.orders = std::move(orders);
  return f;
}

std::vector<int> up_to(int last) {
  std::vector<int> all;
  for (int n = 1; n <= last; ++n) all.push_back(n);
  return all;
}

MotionFunction cosines_over(double duration_s, int count) {
  return {.of = MotionVariable::time,
          .form = cosines,
          .orders = up_to(count),
          .reference = duration_s,
          .range = {{0.0, duration_s}}};
}

// Evenly spaced knots from zero to the largest recorded tilt.
MotionFunction tilt_table(double tilt_rad) {
  constexpr int knots = 8;
  std::vector<double> at;
  for (int i = 0; i < knots; ++i) at.push_back(tilt_rad * i / (knots - 1));
  return {.of = MotionVariable::tilt,
          .form = table,
          .table = SmoothTable(at),
          .range = {{0.0, tilt_rad}}};
}

void add_of_attitude_and_rate(const CoveredMotion& covered, double torque_N_m,
                              std::vector<EmpiricalLaw>& all) {
  using enum MotionVariable;
  for (int order = 1; order <= 8; ++order) {
    all.push_back(law(std::to_string(order) + " periods a turn", {{vertical}, {harmonic(order)}},
                      torque_N_m));
  }
  all.push_back(with_free(
      law("a power", {{lean, vertical}, {power_of(tilt, 3.0, covered.tilt_rad)}}, torque_N_m),
      {2, 3, 4, 5}, 0.3, 9.0, 1.0));
  if (covered.tilt_rad > 0.02) {
    all.push_back(
        law("a smooth function", {{lean, vertical}, {tilt_table(covered.tilt_rad)}}, torque_N_m));
  }
  all.push_back(with_free(
      law("a power", {{rate_by_axis}, {power_of(rate, 2.0, covered.rate_rad_s)}}, torque_N_m),
      {1, 2, 3, 4}, 0.3, 7.0, 1.0));
  for (int order = 1; order <= 4; ++order) {
    all.push_back(law("a drag with " + std::to_string(order) + " periods a turn",
                      {{TorqueAxes::rate},
                       {harmonic(order), powers_of(MotionVariable::rate, {1}, covered.rate_rad_s)}},
                      torque_N_m));
  }
  all.push_back(law("a drag that depends on the tilt",
                    {{TorqueAxes::rate},
                     {powers_of(tilt, {1, 2}, covered.tilt_rad),
                      powers_of(MotionVariable::rate, {1}, covered.rate_rad_s)}},
                    torque_N_m));
}

void add_of_time(double duration_s, double torque_N_m, std::vector<EmpiricalLaw>& all) {
  all.push_back(law("slow", {{body}, {cosines_over(duration_s, 3)}}, torque_N_m));
  all.push_back(law("faster", {{body}, {cosines_over(duration_s, 8)}}, torque_N_m));
  MotionFunction fading{.of = MotionVariable::time, .form = decay, .own = 0.3 * duration_s};
  std::vector<double> starts;
  for (const double fraction : {0.04, 0.1, 0.25, 0.6, 1.5}) {
    starts.push_back(fraction * duration_s);
  }
  all.push_back(with_free(law("fading", {{body, vertical}, {fading}}, torque_N_m), starts,
                          0.01 * duration_s, 10.0 * duration_s, 0.5 * duration_s));
}

}  // namespace

std::vector<EmpiricalLaw> empirical_laws(const CoveredMotion& covered, double torque_N_m) {
  std::vector<EmpiricalLaw> all;
  add_of_attitude_and_rate(covered, torque_N_m, all);
  add_of_time(covered.duration_s, torque_N_m, all);
  if (covered.charge_C > 0.0) {
    for (const int order : {1, 2}) {
      all.push_back(law(order == 1 ? "linear" : "square",
                        {{body},
                         {{.of = MotionVariable::charge,
                           .form = powers,
                           .orders = {order},
                           .reference = covered.charge_C}}},
                        torque_N_m));
    }
  }
  if (covered.has_commands) {
    const auto commanded = [](int order, double reference_N_m) {
      return MotionFunction{.of = MotionVariable::command,
                            .form = powers,
                            .orders = {order},
                            .reference = reference_N_m};
    };
    // The variable is the fraction of the command: a coefficient is the torque at a command of 1 N
    // m.
    all.push_back(law("cross talk", {{cross_talk}, {commanded(1, 1.0)}}, 0.2));
    all.push_back(law("square", {{command}, {commanded(2, 1e-4)}}, 2e-5));
  }
  return all;
}

}  // namespace photorque
