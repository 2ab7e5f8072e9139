// The circuits of the solver under test, solved as plainly as possible: every unknown by a
// bracketed search without derivatives, in 80-bit floats, nested as the network is nested. Slow,
// and shares nothing but the circuit's equations with the solver under test.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/constants.h"
#include "photovoltaics/cell/cell.h"
#include "photovoltaics/network/wiring.h"

namespace photorque::bisection {

using Real = long double;

// The root of a falling function: T. R. Chandrupatla, Adv. Eng. Software 28, 145 (1997).
template <typename Function>
Real root(Real low, Real high, Function&& f) {
  Real a = high, b = low, c = high, fa = f(a), fb = f(b), fc = fa, t = 0.5L;
  for (int i = 0; i < 200 && fb != 0; ++i) {
    const Real x = a + t * (b - a), fx = f(x);
    if ((fx > 0) == (fa > 0)) {
      c = a;
      fc = fa;
    } else {
      c = b;
      fc = fb;
      b = a;
      fb = fa;
    }
    a = x;
    fa = fx;
    const Real best = std::abs(fa) < std::abs(fb) ? a : b;
    const Real fraction = 2e-19L * std::abs(best) / std::abs(b - c);
    if (fa == 0 || fraction > 0.5L) return best;
    const Real xi = (a - b) / (c - b), phi = (fa - fb) / (fc - fb);
    t = phi * phi < xi && (1 - phi) * (1 - phi) < 1 - xi
            ? fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
            : 0.5L;
    t = std::clamp(t, fraction, 1 - fraction);
  }
  return b;
}

inline Real thermal_V(double temperature_K) {
  return static_cast<Real>(boltzmann_J_K) * temperature_K / elementary_charge_C;
}

inline Real dark_A(const CellParameters& p, Real v) {
  const Real vt = thermal_V(p.temperature_K);
  const Real breakdown =
      p.breakdown_fraction == 0
          ? 0.0L
          : p.breakdown_fraction * std::pow(1.0L - v / p.breakdown_V, -Real(p.breakdown_exponent));
  return p.saturation_1_A * std::expm1(v / (p.ideality_1 * vt)) +
         p.saturation_2_A * std::expm1(v / (p.ideality_2 * vt)) +
         v / p.shunt_ohm * (1.0L + breakdown);
}

inline Real cell_V(const CellParameters& p, Real photocurrent_A, Real current_A) {
  const Real lowest = p.breakdown_fraction == 0
                          ? -Real(p.shunt_ohm) * (std::abs(current_A - photocurrent_A) + 1)
                          : Real(p.breakdown_V);
  const Real v =
      root(lowest, 3.0L, [&](Real trial) { return photocurrent_A - current_A - dark_A(p, trial); });
  return v - current_A * p.series_ohm;
}

inline Real cell_A(const CellParameters& p, Real photocurrent_A, Real voltage_V) {
  if (p.series_ohm == 0) return photocurrent_A - dark_A(p, voltage_V);
  const Real lowest = p.breakdown_fraction == 0 ? -1e6L : Real(p.breakdown_V);
  const Real v = root(lowest, 3.0L, [&](Real trial) {
    return photocurrent_A - dark_A(p, trial) - (trial - voltage_V) / p.series_ohm;
  });
  return (v - voltage_V) / p.series_ohm;
}

// Voltage across a diode that carries a forward current ≥ −I_s.
inline Real diode_V(const Diode& d, Real current_A) {
  return d.ideality * thermal_V(d.temperature_K) * std::log1p(current_A / d.saturation_A) +
         current_A * d.series_ohm;
}

struct Array {
  CellParameters cell;
  std::vector<double> photocurrents_A;

  // Voltage of a cell, or of a group of cells with its diode.
  Real row_V(const CellGroup& row, Real current_A) const {
    if (row.is_cell()) {
      return cell_V(cell, photocurrents_A[static_cast<size_t>(row.cell)], current_A);
    }
    return beside_V(row.bypass, current_A, [&](Real i) { return joined_V(row, i); });
  }
  Real joined_V(const CellGroup& row, Real current_A) const {
    if (row.join == CellGroup::Join::series) {
      Real sum = 0;
      for (const CellGroup& part : row.parts) sum += row_V(part, current_A);
      return sum;
    }
    // Were the current shared equally, the voltage would lie between the branches'.
    Real low = 1e3L, high = -1e3L;
    for (const CellGroup& part : row.parts) {
      const Real v = row_V(part, current_A / row.parts.size());
      low = std::min(low, v);
      high = std::max(high, v);
    }
    if (!(low < high)) return low;
    return root(low, high, [&](Real v) {
      Real sum = -current_A;
      for (const CellGroup& part : row.parts) sum += row_A(part, v);
      return sum;
    });
  }
  // An ideal diode takes any current at its voltage: the least is meant.
  Real row_A(const CellGroup& row, Real voltage_V) const {
    if (row.is_cell() && voltage_V > cell.breakdown_V * 0.9999) {
      return cell_A(cell, photocurrents_A[static_cast<size_t>(row.cell)], voltage_V);
    }
    return root(-100.0L, 100.0L, [&](Real i) { return row_V(row, i) - voltage_V; });
  }
  Real rows_V(const ArrayWiring::Substring& substring, Real current_A) const {
    Real sum = 0;
    for (const auto& row : substring.rows) sum += row_V(row, current_A);
    return sum;
  }
  template <typename Inside>
  static Real beside_V(const Diode& d, Real current_A, const Inside& inside_V) {
    if (d.kind == Diode::Kind::none) return inside_V(current_A);
    if (d.kind == Diode::Kind::clamp) return std::max<Real>(inside_V(current_A), -d.drop_V);
    // For the current through the diode: −V_inside(I − i) − V_diode(i) falls with i.
    const Real through = root(-Real(d.saturation_A) * (1 - 1e-18L), std::max<Real>(current_A, 0),
                              [&](Real i) { return -inside_V(current_A - i) - diode_V(d, i); });
    return inside_V(current_A - through);
  }
  Real substring_V(const ArrayWiring::Substring& substring, Real current_A) const {
    return beside_V(substring.bypass, current_A, [&](Real i) { return rows_V(substring, i); });
  }
  Real string_V(const ArrayWiring::String& string, Real current_A) const {
    Real sum = 0;
    for (const auto& substring : string.substrings) sum += substring_V(substring, current_A);
    const Diode& d = string.blocking;
    if (d.kind == Diode::Kind::clamp) sum -= d.drop_V;
    if (d.kind == Diode::Kind::junction) sum -= diode_V(d, current_A);
    return sum;
  }
  Real string_A(const ArrayWiring::String& string, Real voltage_V) const {
    const Diode& d = string.blocking;
    Real low = -100.0L;
    if (d.kind == Diode::Kind::clamp) low = 0.0L;
    if (d.kind == Diode::Kind::junction) low = -Real(d.saturation_A) * (1 - 1e-18L);
    if (d.kind == Diode::Kind::clamp && string_V(string, 0) < voltage_V) return 0;
    return root(low, 100.0L, [&](Real i) { return string_V(string, i) - voltage_V; });
  }
  Real array_A(const ArrayWiring& wiring, Real voltage_V) const {
    Real sum = 0;
    for (const auto& string : wiring.strings) sum += string_A(string, voltage_V);
    return sum;
  }
  Real power_W(const ArrayWiring& wiring, Real x) const {
    return x * (wiring.strings.size() == 1 ? string_V(wiring.strings[0], x) : array_A(wiring, x));
  }
  // The height of a maximum near x (the current for one string, the voltage for several): vertex of
  // the parabola through three points. They are apart so little that the next term of the
  // power's series is below 1e-11 of it.
  Real power_near(const ArrayWiring& wiring, double x) const {
    const Real h = 1e-5L;
    const Real low = power_W(wiring, x * (1 - h)), at = power_W(wiring, x),
               high = power_W(wiring, x * (1 + h));
    const Real slope = 0.5L * (high - low), bend = high + low - 2 * at;
    return at - 0.5L * slope * slope / bend;
  }
};

}  // namespace photorque::bisection
