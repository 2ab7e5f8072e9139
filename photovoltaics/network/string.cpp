#include "photovoltaics/network/string.h"

#include <algorithm>
#include <cmath>

#include "core/numerics/root.h"

namespace photorque {
namespace {

// Largest slope resistance of a junction: its current is then below rounding, and its cube finite.
constexpr double max_ohm = 1e90;

}  // namespace

StringState StringCurve::make_state() const {
  StringState state;
  state.cells.resize(cells_.size());
  state.parts.resize(parts_.size());
  return state;
}

StringRegime StringCurve::regime_at(double current_A) const {
  StringRegime regime;
  regime.clamped.reserve(parts_.size());
  for (const Part& p : parts_) regime.clamped.push_back(current_A >= p.clamp_A);
  return regime;
}

std::vector<double> StringCurve::clamp_currents_A() const {
  std::vector<double> currents;
  currents.reserve(parts_.size());
  for (const Part& p : parts_) currents.push_back(p.clamp_A);
  return currents;
}

double StringCurve::lowest_V() const {
  double sum_V = -blocking_drop_V(0.0);
  for (uint32_t k = 0; k < substrings_; ++k) sum_V += parts_[k].lowest_V;
  return sum_V;
}

double StringCurve::first_guess_A() const {
  double guess_A = largest_photocurrent_A_;
  for (uint32_t k = 0; k < substrings_; ++k) guess_A = std::min(guess_A, parts_[k].clamp_A);
  return guess_A;
}

ElementPoint StringCurve::substrings_at(double current_A, const StringRegime& regime,
                                        double tolerance, StringState& state) const {
  ElementPoint sum;
  for (uint32_t k = 0; k < substrings_; ++k) {
    sum += part_at(k, current_A, &regime, tolerance, state);
  }
  return sum;
}

double StringCurve::blocking_drop_V(double current_A) const {
  switch (blocking_.kind) {
    case Diode::Kind::clamp:
      return blocking_.drop_V;
    case Diode::Kind::junction:
      return blocking_.scale_V * std::log1p(current_A / blocking_.saturation_A) +
             current_A * blocking_.series_ohm;
    case Diode::Kind::none:
      break;
  }
  return 0.0;
}

void StringCurve::at_current(double current_A, const StringRegime& regime, double tolerance,
                             StringState& state) const {
  static_cast<ElementPoint&>(state) = substrings_at(current_A, regime, tolerance, state);
  state.voltage_V -= blocking_drop_V(current_A);
  state.current_A = current_A;
  if (blocking_.kind == Diode::Kind::junction) add_blocking(state);
}

// Adds the derivatives of a blocking junction in series.
void StringCurve::add_blocking(StringState& state) const {
  const double junction_ohm =
      std::min(blocking_.scale_V / (state.current_A + blocking_.saturation_A), max_ohm);
  state.blocking_ohm = junction_ohm;
  state.slope_ohm += junction_ohm + blocking_.series_ohm;
  const double bend = junction_ohm * junction_ohm * blocking_.per_scale_1_V;
  state.curvature_V_A2 += bend;
  state.third_V_A3 -= 2.0 * bend * junction_ohm * blocking_.per_scale_1_V;
}

// Backwards through a blocking junction the current is below I_s; its voltage z is the remainder.
void StringCurve::reverse_at_voltage(double voltage_V, const StringRegime& regime,
                                     StringState& state) const {
  ElementPoint sum;
  double junction_S = 0.0, current_A = 0.0;
  const auto surplus_V = [&](double z) {
    current_A = blocking_.saturation_A * std::expm1(z * blocking_.per_scale_1_V);
    junction_S = (current_A + blocking_.saturation_A) * blocking_.per_scale_1_V;
    sum = substrings_at(current_A, regime, 1e-9, state);
    const double ohm = sum.slope_ohm + blocking_.series_ohm;
    return FunctionAt{
        sum.voltage_V - current_A * blocking_.series_ohm - z - voltage_V, -ohm * junction_S - 1.0,
        (sum.curvature_V_A2 * junction_S - ohm * blocking_.per_scale_1_V) * junction_S};
  };
  const double left_over_V = open_circuit_V_ - voltage_V;
  const double z = falling_root(left_over_V, 0.0, left_over_V, 1e-9, surplus_V);
  const double junction_ohm = std::min(1.0 / junction_S, max_ohm);
  state.blocking_ohm = junction_ohm;
  state.current_A = blocking_.saturation_A * std::expm1(z * blocking_.per_scale_1_V);
  state.voltage_V = voltage_V;
  state.slope_ohm = sum.slope_ohm + blocking_.series_ohm + junction_ohm;
  const double bend = junction_ohm * junction_ohm * blocking_.per_scale_1_V;
  state.curvature_V_A2 = sum.curvature_V_A2 + bend;
  state.third_V_A3 = sum.third_V_A3 - 2.0 * bend * junction_ohm * blocking_.per_scale_1_V;
}

// With the current r through the cells as the unknown, everything is explicit: their voltage, the
// current i ≤ 0 of the diode in parallel, the string's current I = r + i and its voltage.
FunctionAt StringCurve::beside_junction(double rows_A, double voltage_V, const StringRegime& regime,
                                        ElementPoint& rows, StringState& state) const {
  const DiodeJunction& bypass = parts_[0].bypass;
  rows = inside_at(0, rows_A, &regime, 1e-9, state);
  const double i_A = bypass.current_A(bypass.junction_V(-rows.voltage_V));
  const double current_A = std::max(rows_A + i_A, 0.0);
  FunctionAt f{rows.voltage_V - voltage_V, -rows.slope_ohm, rows.curvature_V_A2, rows.third_V_A3,
               true};
  f.value -= blocking_drop_V(current_A);
  if (blocking_.kind == Diode::Kind::junction) {
    // Derivatives of I by r, then of the blocking diode's voltage.
    const Slopes d = bypass.slopes(bypass.conductance_S(i_A));
    const double a = rows.slope_ohm, b = rows.curvature_V_A2, c = rows.third_V_A3;
    const double i1 = 1.0 + d.slope * a, i2 = d.curvature * a * a - d.slope * b;
    const double i3 = -d.third * a * a * a - 3.0 * d.curvature * a * b - d.slope * c;
    const double ohm = 1.0 / blocking_.conductance_S(current_A);
    const double w1 = ohm + blocking_.series_ohm, w2 = -ohm * ohm * blocking_.per_scale_1_V;
    const double w3 = -2.0 * w2 * ohm * blocking_.per_scale_1_V;
    f.slope -= w1 * i1;
    f.curvature -= w2 * i1 * i1 + w1 * i2;
    f.third -= w3 * i1 * i1 * i1 + 3.0 * w2 * i1 * i2 + w1 * i3;
  }
  f.close = close(f.value);
  return f;
}

void StringCurve::beside_junction_at_voltage(double voltage_V, const StringRegime& regime,
                                             double low_A, double high_A, double tolerance,
                                             StringState& state) const {
  const DiodeJunction& bypass = parts_[0].bypass;
  StringState::Part& last = state.parts[0];
  ElementPoint rows;
  double at_A = 0.0;
  const double rows_V = voltage_V + blocking_drop_V(std::max(state.current_A, 0.0));
  const double guess_A = state.current_A - bypass.current_A(bypass.junction_V(-rows_V));
  const double root_A =
      falling_root(low_A, high_A + bypass.saturation_A, guess_A, tolerance, [&](double rows_A) {
        at_A = rows_A;
        return beside_junction(rows_A, voltage_V, regime, rows, state);
      });
  // The result is extrapolated to third order in the last step.
  const double step_A = root_A - at_A;
  rows.voltage_V -=
      step_A *
      (rows.slope_ohm - step_A * (rows.curvature_V_A2 / 2.0 + step_A * rows.third_V_A3 / 6.0));
  rows.slope_ohm -= step_A * (rows.curvature_V_A2 + 0.5 * step_A * rows.third_V_A3);
  rows.curvature_V_A2 += step_A * rows.third_V_A3;
  const double u = bypass.junction_V(-rows.voltage_V), i_A = bypass.current_A(u);
  const double g = bypass.conductance_S(i_A);
  Slopes current = inverted(rows.slopes());
  current += bypass.slopes(g);
  static_cast<ElementPoint&>(state) = tied_point(voltage_V, current);
  state.current_A = root_A + i_A;
  last = {u, g, state.current_A, tied_point(rows.voltage_V, current)};
  if (blocking_.kind == Diode::Kind::junction) add_blocking(state);
}

void StringCurve::at_voltage(double voltage_V, const StringRegime& regime, double low_A,
                             double high_A, double tolerance, StringState& state) const {
  if (regime.blocked) {
    state.current_A = 0.0;
    static_cast<ElementPoint&>(state) = {voltage_V, unlimited, 0.0, 0.0};
    return;
  }
  if (blocking_.kind == Diode::Kind::junction && voltage_V >= open_circuit_V_) {
    reverse_at_voltage(voltage_V, regime, state);
    return;
  }
  const bool one = substrings_ == 1 && parts_[0].bypass.kind == Diode::Kind::junction;
  if (one && voltage_V >= 0.0 && voltage_V < open_circuit_V_) {
    beside_junction_at_voltage(voltage_V, regime, std::max(low_A, 0.0), high_A, tolerance, state);
    return;
  }
  const auto excess_V = [&](double current_A) {
    at_current(current_A, regime, tolerance, state);
    const double excess = state.voltage_V - voltage_V;
    return FunctionAt{excess, -state.slope_ohm, state.curvature_V_A2, state.third_V_A3,
                      close(excess)};
  };
  if (voltage_V < 0.0) {
    const double guess_A = state.current_A;
    widen(low_A, high_A, 1e-3 * high_A + 1e-9,
          [&](double current_A) { return excess_V(current_A).value > 0.0; });
    state.current_A = guess_A;
  }
  if (voltage_V > open_circuit_V_ && low_A >= 0.0) {
    // The other strings drive a reverse current through this one.
    high_A = 0.0;
    low_A = -(1e-3 * largest_photocurrent_A_ + 1e-9);
    widen(high_A, low_A, low_A, [&](double current_A) { return excess_V(current_A).value < 0.0; });
  }
  const double root_A = falling_root(low_A, high_A, state.current_A, tolerance, excess_V);
  const double step_A = root_A - state.current_A;
  state.slope_ohm -= step_A * (state.curvature_V_A2 + 0.5 * step_A * state.third_V_A3);
  state.curvature_V_A2 += step_A * state.third_V_A3;
  state.current_A = root_A;
  state.voltage_V = voltage_V;
}

}  // namespace photorque
